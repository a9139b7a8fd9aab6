//! The numbers that are looked for.

use pneuflex::model::CaseError;
use pneuflex_sweep::node::Node;
use toml::Value;

/// Keys of the positions on the load path. As a variable one is that of the only state.
pub const PATH: [&str; 2] = ["load.pressure_kpa", "load.times"];

/// A number that is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name: its key, or what stands for several.
    pub name: String,
    /// The keys that have its value.
    pub keys: Vec<String>,
    /// Where the search begins; `None` for the value in the case.
    pub start: Option<f64>,
    /// The least and the largest value.
    pub bounds: [f64; 2],
}

impl Variable {
    /// The key by which results are differentiated: of several keys one that stands for all of them.
    pub fn key(&self) -> String {
        self.keys.join("+")
    }

    /// Its keys with a value, as changes in TOML.
    pub fn changes(&self, value: f64) -> impl Iterator<Item = (String, String)> + '_ {
        // With a full stop, as a float of TOML.
        let change = move |key: &String| {
            (key.clone(), if PATH.contains(&key.as_str()) { format!("[{value:?}]") } else { format!("{value:?}") })
        };
        self.keys.iter().map(change)
    }
}

/// The variables of a table: by key `{ from = …, to = … }`, or by any name with the `keys` that it stands for; both with or without `start`.
///
/// # Errors
/// Everything that is wrong with it.
pub fn variables(table: &Node) -> Result<Vec<Variable>, Vec<CaseError>> {
    let (mut found, mut wrong): (Vec<Variable>, Vec<CaseError>) = (Vec::new(), Vec::new());
    for (name, node) in table.leaves() {
        match variable(&name, node) {
            Ok(variable) => {
                let is_taken = |key: &&String| found.iter().any(|other| other.keys.contains(*key));
                if let Some(key) = variable.keys.iter().find(is_taken) {
                    wrong.push(problem(&name, key.clone(), "must be in one variable only"));
                }
                found.push(variable);
            }
            Err((value, allowed)) => wrong.push(problem(&name, value, &allowed)),
        }
    }
    if found.is_empty() && wrong.is_empty() {
        let allowed = "must have keys with bounds, e.g. \"material.c10\" = { from = 0.1, to = 1 }".to_owned();
        wrong.push(CaseError { key: "variables".into(), value: "nothing".into(), allowed });
    }
    if wrong.is_empty() { Ok(found) } else { Err(wrong) }
}

/// The variable of a name or a key.
pub fn find(variables: &[Variable], name: &str) -> Option<usize> {
    let is_it = |variable: &Variable| variable.name == name || variable.keys.iter().any(|key| key == name);
    variables.iter().position(is_it)
}

fn problem(name: &str, value: String, allowed: &str) -> CaseError {
    CaseError { key: format!("variables.{name}"), value, allowed: allowed.to_owned() }
}

/// A variable, or what is there in its place and what it must be.
fn variable(name: &str, node: &Node) -> Result<Variable, (String, String)> {
    let value = node.value();
    let refused = |allowed: &str| (value.to_string(), allowed.to_owned());
    let expected = "must be { from = …, to = … }, with or without start, and keys if it is a name for several";
    let Value::Table(table) = &value else { return Err(refused(expected)) };
    if table.keys().any(|key| !["from", "to", "start", "keys"].contains(&key.as_str())) {
        return Err(refused(expected));
    }
    let number = |key: &str| -> Result<Option<f64>, (String, String)> {
        let Some(value) = table.get(key) else { return Ok(None) };
        let number = value.as_float().or(value.as_integer().map(|whole| whole as f64));
        number.filter(|number| number.is_finite()).map(Some).ok_or_else(|| refused(&format!("{key} must be a number")))
    };
    let (Some(from), Some(to)) = (number("from")?, number("to")?) else { return Err(refused(expected)) };
    let start = number("start")?;
    if from >= to {
        return Err(refused("must be from a number to a larger one"));
    }
    if start.is_some_and(|start| start < from || start > to) {
        return Err(refused("must start between its bounds"));
    }
    let keys = match table.get("keys") {
        None => vec![name.to_owned()],
        Some(Value::Array(keys)) if !keys.is_empty() => {
            let keys: Option<Vec<String>> = keys.iter().map(|key| key.as_str().map(str::to_owned)).collect();
            keys.ok_or_else(|| refused("keys must be texts"))?
        }
        Some(_) => return Err(refused("keys must be a list of texts")),
    };
    if keys.iter().enumerate().any(|(i, key)| keys[..i].contains(key)) {
        return Err(refused("must have every key once"));
    }
    Ok(Variable { name: name.to_owned(), keys, start, bounds: [from, to] })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_are_keys_or_names_for_several() {
        let read = |text: &str| variables(&toml::from_str(text).unwrap());
        let found = read(
            "material.c10 = { from = 0.1, to = 1 }\n\"actuator.gap[2]\" = { from = 1.0, to = 2.0, start = 1.5 }\n\
             wall = { keys = [\"actuator.side_wall\", \"actuator.top_wall\"], from = 0.8, to = 2 }",
        )
        .unwrap();
        assert_eq!(
            found.iter().map(|v| v.name.as_str()).collect::<Vec<_>>(),
            ["material.c10", "actuator.gap[2]", "wall"]
        );
        assert_eq!((found[1].start, found[1].bounds), (Some(1.5), [1.0, 2.0]));
        assert_eq!(found[2].keys, ["actuator.side_wall", "actuator.top_wall"]);
        let changes: Vec<_> = found[2].changes(1.0).collect();
        assert_eq!(changes[1], ("actuator.top_wall".to_owned(), "1.0".to_owned()));
        for (text, words) in [
            ("", "must have keys with bounds"),
            ("a = 1", "must be { from"),
            ("a = { from = 1 }", "must be { from"),
            ("a = { from = 2, to = 1 }", "to a larger one"),
            ("a = { from = 1, to = 2, start = 3 }", "must start between"),
            ("a = { from = 1, to = nan }", "to must be a number"),
            ("a = { from = 1, to = 2, keys = [] }", "a list of texts"),
            ("a = { from = 1, to = 2, step = 3 }", "must be { from"),
            ("a = { from = 1, to = 2, keys = [\"b\", \"b\"] }", "every key once"),
            ("a = { from = 1, to = 2 }\nb = { from = 1, to = 2, keys = [\"a\"] }", "in one variable only"),
        ] {
            let error = read(text).unwrap_err()[0].to_string();
            assert!(error.contains(words), "{text}: {error}");
        }
    }
}
