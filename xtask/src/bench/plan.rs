//! Which cases are measured.

use super::arguments::Arguments;

/// Why a case is in the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Series {
    /// A fixture of the paper as it is.
    Paper,
    /// Eight chambers to 50 kPa, one resolution.
    Resolution,
    /// One load step to 5 kPa, any number of chambers.
    Chambers,
}

/// One run of the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Why it is measured.
    pub series: Series,
    /// Its case file in `fixtures`.
    pub fixture: &'static str,
    /// Number of chambers.
    pub chambers: usize,
    /// `mesh.resolution`, or the fixture's own mesh in words.
    pub resolution: String,
    /// Number of threads.
    pub threads: usize,
    /// `--set` changes to the fixture.
    pub changes: Vec<String>,
}

impl Run {
    fn paper(fixture: &'static str, chambers: usize, threads: usize) -> Self {
        let changes = vec!["output.fields=false".to_owned()];
        Self { series: Series::Paper, fixture, chambers, resolution: "1 mm".to_owned(), threads, changes }
    }

    fn actuator(series: Series, chambers: usize, resolution: &str, threads: usize) -> Self {
        let mut changes = vec![
            format!("mesh.resolution={resolution}"),
            "material.invariant=isochoric".to_owned(),
            format!("actuator.chambers={chambers}"),
            "output.fields=false".to_owned(),
        ];
        if series == Series::Chambers {
            changes.push("load.pressure_kpa=[5]".to_owned());
        }
        Self { series, fixture: "actuator.toml", chambers, resolution: resolution.to_owned(), threads, changes }
    }

    /// Name of the output folder.
    pub fn name(&self) -> String {
        let series = match self.series {
            Series::Paper => "paper",
            Series::Resolution => "50kpa",
            Series::Chambers => "5kpa",
        };
        let mesh = self.resolution.replace(' ', "-");
        format!("{series}-{}-chambers-{mesh}-{}-threads", self.chambers, self.threads)
    }
}

/// All runs in the order of the table.
pub fn runs(arguments: &Arguments) -> Vec<Run> {
    let mut runs = Vec::new();
    for (fixture, chambers) in [("two_chamber.toml", 2), ("actuator.toml", 8)] {
        if chambers == 2 || !arguments.is_quick {
            runs.extend([1, 2].map(|threads| Run::paper(fixture, chambers, threads)));
        }
    }
    for resolution in &arguments.resolutions {
        runs.extend([1, 2].map(|threads| Run::actuator(Series::Resolution, 8, resolution, threads)));
    }
    let scaled: &[&str] = if arguments.is_full { &["draft", "standard"] } else { &["draft"] };
    for resolution in scaled {
        runs.extend(arguments.chambers.iter().map(|&n| Run::actuator(Series::Chambers, n, resolution, 2)));
    }
    runs
}
