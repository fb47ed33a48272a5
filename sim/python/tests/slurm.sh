#!/usr/bin/env bash
# A Slurm of one machine on loopback, for the tests: Debian's slurm-wlm and munge, as root. Configuration and state lie
# in /etc/slurm and in the folder that is named (a temporary one). `slurm.sh stop` ends what it started.
set -euo pipefail
state=${SLURM_STATE:-/tmp/splatline-slurm}
if [ "${1:-}" = stop ]; then
    for daemon in slurmd slurmctld munged; do [ -e "$state/$daemon.pid" ] && kill "$(cat "$state/$daemon.pid")" && rm -f "$state/$daemon.pid"; done
    exit 0
fi
command -v slurmctld munged >/dev/null || { echo "slurm-wlm and munge are not installed" >&2; exit 77; }
mkdir -p "$state" /etc/slurm /run/munge
host=$(hostname -s)
cat >/etc/slurm/slurm.conf <<CONF
ClusterName=loopback
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmctldPidFile=$state/slurmctld.pid
SlurmdPidFile=$state/slurmd.pid
SlurmctldLogFile=$state/slurmctld.log
SlurmdLogFile=$state/slurmd.log
StateSaveLocation=$state/ctld
SlurmdSpoolDir=$state/d
SlurmctldPort=16817
SlurmdPort=16818
ReturnToService=2
MailProg=/bin/true
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
chown munge: /run/munge
[ -e /etc/munge/munge.key ] || { dd if=/dev/urandom of=/etc/munge/munge.key bs=1024 count=1 status=none; chown munge: /etc/munge/munge.key; chmod 400 /etc/munge/munge.key; }
runuser -u munge -- munged --force --num-threads=2
cp /run/munge/munged.pid "$state/munged.pid" 2>/dev/null || true
mkdir -p "$state/ctld" "$state/d"
slurmctld
slurmd
for _ in $(seq 50); do
    case $(sinfo -h -o %T 2>/dev/null || true) in idle* | mixed*) sinfo; exit 0 ;; esac
    sleep 0.2
done
echo "the node did not come up: see $state" >&2
exit 1
