//! Arguments of `cargo xtask bench`.

use std::path::PathBuf;

pub const USAGE: &str =
    "usage: cargo xtask bench [--quick] [--full] [--chambers LIST] [--resolutions LIST] [--out FILE.json]

  --quick             two chambers at 1 mm, eight chambers at draft, two to eight chambers: half a minute without CalculiX
  --full              the rows over the number of chambers at standard, too
  --chambers LIST     numbers of chambers of these rows, separated by commas [default: 2,4,8,16,32,64]
  --resolutions LIST  resolutions of the eight chambers [default: draft,standard,fine]
  --out FILE.json     write all numbers to a file, too";

/// Names of `mesh.resolution`, coarsest first.
const RESOLUTIONS: [&str; 3] = ["draft", "standard", "fine"];

/// What is to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Arguments {
    /// Small cases only.
    pub is_quick: bool,
    /// Rows over the number of chambers at `standard`, too.
    pub is_full: bool,
    /// Numbers of chambers.
    pub chambers: Vec<usize>,
    /// Resolutions of the eight chambers.
    pub resolutions: Vec<String>,
    /// File for all numbers.
    pub out: Option<PathBuf>,
}

impl Arguments {
    /// Reads the words after `bench`.
    ///
    /// # Errors
    /// An unknown argument, a missing or a bad value.
    pub fn read(words: &[String]) -> Result<Self, String> {
        let mut read = Self { is_quick: false, is_full: false, chambers: vec![], resolutions: vec![], out: None };
        let mut rest = words.iter();
        while let Some(word) = rest.next() {
            let mut value = || rest.next().ok_or_else(|| format!("{word} needs a value\n{USAGE}"));
            match word.as_str() {
                "--quick" => read.is_quick = true,
                "--full" => read.is_full = true,
                "--chambers" => read.chambers = chambers(value()?)?,
                "--resolutions" => read.resolutions = resolutions(value()?)?,
                "--out" => read.out = Some(value()?.into()),
                other => return Err(format!("unknown argument {other}\n{USAGE}")),
            }
        }
        if read.is_quick && read.is_full {
            return Err("--quick and --full exclude each other".to_owned());
        }
        if read.chambers.is_empty() {
            read.chambers = if read.is_quick { vec![2, 4, 8] } else { vec![2, 4, 8, 16, 32, 64] };
        }
        if read.resolutions.is_empty() {
            let count = if read.is_quick { 1 } else { RESOLUTIONS.len() };
            read.resolutions = RESOLUTIONS[..count].iter().map(|&name| name.to_owned()).collect();
        }
        Ok(read)
    }
}

fn chambers(list: &str) -> Result<Vec<usize>, String> {
    let number = |word: &str| word.trim().parse::<usize>().ok().filter(|n| (1..=1024).contains(n));
    let numbers: Option<Vec<usize>> = list.split(',').map(number).collect();
    let mut numbers =
        numbers.ok_or_else(|| format!("--chambers {list}: must be numbers from 1 to 1024, as in 2,4,8"))?;
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

fn resolutions(list: &str) -> Result<Vec<String>, String> {
    let names: Vec<&str> = list.split(',').map(str::trim).collect();
    match names.iter().find(|name| !RESOLUTIONS.contains(name)) {
        None => Ok(RESOLUTIONS.iter().filter(|name| names.contains(name)).map(|&name| name.to_owned()).collect()),
        Some(name) => Err(format!("--resolutions {list}: {name:?} is none of {}", RESOLUTIONS.join(", "))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Arguments, String> {
        Arguments::read(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>())
    }

    #[test]
    fn lists_are_sorted_and_checked() {
        let arguments = read("--chambers 16,4,4 --resolutions fine,draft --out a.json").unwrap();
        assert_eq!((arguments.chambers, arguments.resolutions), (vec![4, 16], vec!["draft".into(), "fine".into()]));
        assert_eq!(read("").unwrap().chambers.last(), Some(&64));
        assert_eq!(read("--quick").unwrap().resolutions, ["draft"]);
        for bad in ["--chambers", "--chambers 0", "--chambers 4,x", "--resolutions medium", "--quick --full", "--fast"]
        {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
