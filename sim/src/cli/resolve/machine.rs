//! From options to a machine, the part that it is built on, and the prices of both.

use crate::cli::machine_args::{MachineOptions, SimulationOptions};
use crate::cli::output::settings;
use crate::cli::say::usage;
use crate::machine::area::Calibration;
use crate::machine::config::{self, Config};
use crate::machine::energy::EnergyTable;
use crate::machine::parts::Parts;
use crate::machine::record::Prices;
use anyhow::Result;
use std::path::PathBuf;

/// Refuses lists that keep the order of the picture before.
pub fn refuse_kept_order(machine: &Config) -> Result<()> {
    match machine.sort_every {
        1 => Ok(()),
        every => Err(usage(format!(
            "sort_every = {every}: allowed is 1 here: `simulate` with a --camera-path keeps the order of the picture before, and nothing else does"
        ))),
    }
}

/// The machine that the options describe.
pub fn machine(options: &MachineOptions) -> Result<Config> {
    change_machine(options, Config::default())
}

/// The machine that the options name, or else this one, with the changes that they ask for.
pub(super) fn change_machine(options: &MachineOptions, unnamed: Config) -> Result<Config> {
    let mut config = match &options.machine {
        Some(path) => match path.to_str().and_then(Config::named) {
            Some(config) => config,
            None => config::from_file(path)?,
        },
        None => unnamed,
    };
    config
        .set_words(&options.set)
        .map_err(|error| usage(error.to_string()))?;
    Ok(config)
}

/// What area and energy are counted by: of area a file's prices, or those of the part's family or of the one named.
pub fn prices(options: &SimulationOptions) -> Result<Prices> {
    let area = &options.area;
    let mut parts = Parts::default();
    if let Some(path) = &area.parts {
        parts = settings(path, |file, text| parts.clone().and(file, text))?;
    }
    let found = |name: &String| parts.find(name).map(|part| (name.clone(), part.clone()));
    let part = area.part.as_ref().map(found).transpose().map_err(usage)?;
    let family = part.as_ref().map_or(area.family, |(_, part)| part.family);
    Ok(Prices {
        calibration: match &area.calibration {
            None => family.calibration(),
            Some(path) => settings(path, Calibration::from_toml)?,
        },
        part,
        energy: energy_table(options.energy.as_ref())?,
    })
}

/// The table of energies that was asked for, or the one that ships.
pub fn energy_table(file: Option<&PathBuf>) -> Result<EnergyTable> {
    match file {
        None => Ok(EnergyTable::default()),
        Some(path) => settings(path, EnergyTable::from_toml),
    }
}
