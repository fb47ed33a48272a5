//! The actions as an action-count file of Accelergy, for those who have energies of their own there.
//!
//! Its layout is `action_counts: {version, local: [{name, action_counts: [{name, arguments, counts}]}]}`: a component of a unit is a local
//! component `splatline.<unit>.<component>_<bits>x<bits>`, because operands are attributes of a component in Accelergy and not of an action.

use super::Energy;
use std::fmt::Write;

/// The file's text.
pub fn action_counts(energy: &Energy) -> String {
    let mut text = String::from("action_counts:\n  version: 0.4\n  local:\n");
    for unit in &energy.units {
        let mut last = None;
        for action in &unit.actions {
            let [a, b] = action.bits;
            let component = (action.component, a, b);
            // Reads and writes of a memory follow each other.
            if last != Some(component) {
                // Writing to a String cannot fail.
                let _ = writeln!(
                    text,
                    "    - name: splatline.{}.{}_{a}x{b}\n      action_counts:",
                    unit.unit, action.component
                );
            }
            last = Some(component);
            let _ = writeln!(
                text,
                "        - name: {}\n          counts: {}",
                action.action, action.count
            );
        }
    }
    text
}
