//! Where two JSON values differ, so that a message can say what differs and not only that something does.

use serde_json::Value;

/// Letters of a value that are quoted at most.
const SHORT: usize = 48;

/// One place where they differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Keys and indices from the top, parted by points; with the line where a text of several lines differs.
    pub place: String,
    /// The first one's value there, shortened.
    pub first: String,
    pub second: String,
}

/// All of them, in the first one's order.
pub fn differences(first: &Value, second: &Value) -> Vec<Difference> {
    let mut found = Vec::new();
    walk("", Some(first), Some(second), &mut found);
    found
}

fn walk(place: &str, first: Option<&Value>, second: Option<&Value>, found: &mut Vec<Difference>) {
    let below = |key: &str| match place {
        "" => key.to_owned(),
        _ => format!("{place}.{key}"),
    };
    match (first, second) {
        (first, second) if first == second => {}
        (Some(Value::Object(first)), Some(Value::Object(second))) => {
            let only_second = second.keys().filter(|key| !first.contains_key(*key));
            for key in first.keys().chain(only_second) {
                walk(&below(key), first.get(key), second.get(key), found);
            }
        }
        (Some(Value::Array(first)), Some(Value::Array(second))) if first.len() == second.len() => {
            for (index, (first, second)) in first.iter().zip(second).enumerate() {
                walk(&below(&index.to_string()), Some(first), Some(second), found);
            }
        }
        (Some(Value::String(first)), Some(Value::String(second)))
            if first.contains('\n') || second.contains('\n') =>
        {
            let (line, first, second) = first_line(first, second);
            found.push(Difference {
                place: format!("{place}, line {line}"),
                first: format!("'{}'", short(first)),
                second: format!("'{}'", short(second)),
            });
        }
        (first, second) => {
            let [first, second] = [first, second].map(|value| match value {
                Some(value) => short(&value.to_string()),
                None => "nothing".to_owned(),
            });
            found.push(Difference {
                place: place.to_owned(),
                first,
                second,
            });
        }
    }
}

/// Number and text of the first line that differs.
fn first_line<'a>(first: &'a str, second: &'a str) -> (usize, &'a str, &'a str) {
    let lines = first.split('\n').zip(second.split('\n'));
    let same = lines.take_while(|(first, second)| first == second).count();
    let line = |text: &'a str| text.split('\n').nth(same).unwrap_or_default();
    (same + 1, line(first), line(second))
}

fn short(text: &str) -> String {
    match text.char_indices().nth(SHORT) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_kind_of_difference_is_placed() {
        let first = json!({"a": 1, "b": {"c": [1, 2]}, "d": "x\ny\nz", "e": [1], "f": null});
        let second = json!({"a": 1, "b": {"c": [1, 3]}, "d": "x\nY\nz", "e": [1, 2], "g": true});
        let shown: Vec<String> = differences(&first, &second)
            .into_iter()
            .map(|d| format!("{}: {} / {}", d.place, d.first, d.second))
            .collect();
        assert_eq!(
            shown,
            [
                "b.c.1: 2 / 3",
                "d, line 2: 'y' / 'Y'",
                "e: [1] / [1,2]",
                "f: null / nothing",
                "g: nothing / true"
            ]
        );
        assert!(differences(&first, &first).is_empty());
    }
}
