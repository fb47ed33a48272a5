//! The actions as an action-count file of Accelergy, for those who have energies of their own there.
//!
//! Its layout is `action_counts: {version, local: [{name, action_counts: [{name, arguments, counts}]}]}`: a component
//! of a unit is a local component `splatline.<unit>.<component>_<bits>x<bits>`, because operands are attributes of a
//! component in Accelergy and not of an action.

use super::Energy;

/// The file's text.
pub fn action_counts(energy: &Energy) -> String {
    let mut text = String::from("action_counts:\n  version: 0.4\n  local:\n");
    for unit in &energy.units {
        let mut last = None;
        for action in &unit.actions {
            let (name, [a, b]) = (unit.unit, action.bits);
            let component = format!(
                "    - name: splatline.{name}.{}_{a}x{b}\n",
                action.component
            );
            // Reads and writes of a memory follow each other.
            if last.as_ref() != Some(&component) {
                text += &component;
                text += "      action_counts:\n";
            }
            last = Some(component);
            let (name, count) = (action.action, action.count);
            text += &format!("        - name: {name}\n          counts: {count}\n");
        }
    }
    text
}
