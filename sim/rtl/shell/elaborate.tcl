# FuseSoC's step before Icarus Verilog 11, which reads no packages of types: the elaborated circuit as plain Verilog.
yosys -import
source edalize_yosys_procs.tcl
verilog_defaults -push
verilog_defaults -add -defer
read_files
set_params
verilog_defaults -pop
hierarchy -top $top
yosys rename -top $top
yosys proc
opt_clean
write_verilog -noattr $name.v
