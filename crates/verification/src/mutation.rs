//! Damaged inputs of every reader: none may panic, run on, or be read as something that cannot be described.
//!
//! Inputs are the files of random problems ([`crate::relations`]) and others that are given, each with a few changes: bytes, lines, numbers that
//! are hardly numbers, pieces of other files. A number of an input gives the same input again.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;

use pneuflex::calibration::clean::{Cleaning, clean};
use pneuflex::calibration::curve::{ReadOptions, decode, read};
use pneuflex::{MemoryLimit, Study};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::relations::{Dice, Draw, Files, Form, Scale};

/// A reader takes longer than this, s: it is as if it had not ended.
const LONG: f64 = 5.0;

/// Bodies with more elements are not meshed here.
const FEW: f64 = 2000.0;

/// What is tried.
#[derive(Clone, Debug)]
pub struct Options {
    /// Number of inputs.
    pub inputs: usize,
    /// Seed of all of them.
    pub seed: u64,
    /// Files that are damaged beside those of random problems: the one that is given to the program first.
    pub seeds: Vec<Files>,
}

/// What became of the inputs of a reader.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally {
    /// The reader: the end of the damaged file's name, and of the file that it lies beside.
    pub reader: String,
    /// Inputs.
    pub tried: usize,
    /// Of these, read and described.
    pub read: usize,
    /// Refused with a message.
    pub refused: usize,
    /// The longest time, s.
    pub longest: f64,
}

/// An input that a reader cannot bear.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Its number.
    pub input: usize,
    /// What happened.
    pub why: String,
    /// The files.
    pub files: Files,
}

enum Fate {
    Read,
    Refused,
    Wrong(String),
}

/// Tries damaged inputs, telling `observe` about those that a reader cannot bear.
pub fn run(options: &Options, observe: &(dyn Fn(&Fault) + Sync)) -> Vec<Tally> {
    let tallies: Mutex<Vec<Tally>> = Mutex::new(Vec::new());
    let next = AtomicUsize::new(0);
    let workers = thread::available_parallelism().map_or(1, usize::from);
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(|| {
                let mut pool = Pool::default();
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= options.inputs {
                        return;
                    }
                    let (reader, files) = pool.input(options, number);
                    let began = Instant::now();
                    let fate = catch_unwind(AssertUnwindSafe(|| fate(&files)));
                    let seconds = began.elapsed().as_secs_f64();
                    let fate = match fate {
                        Ok(_) if seconds > LONG => Fate::Wrong(format!("it took {seconds:.1} s")),
                        Ok(fate) => fate,
                        Err(_) => Fate::Wrong("it panicked".into()),
                    };
                    if let Fate::Wrong(why) = &fate {
                        observe(&Fault { input: number, why: why.clone(), files });
                    }
                    let mut tallies = tallies.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                    let at = tallies.iter().position(|tally| tally.reader == reader).unwrap_or_else(|| {
                        tallies.push(Tally { reader, ..Tally::default() });
                        tallies.len() - 1
                    });
                    tallies[at].add(&fate, seconds);
                }
            });
        }
    });
    let mut tallies = tallies.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    tallies.sort_by(|a, b| a.reader.cmp(&b.reader));
    tallies
}

impl Tally {
    fn add(&mut self, fate: &Fate, seconds: f64) {
        self.tried += 1;
        self.read += usize::from(matches!(fate, Fate::Read));
        self.refused += usize::from(matches!(fate, Fate::Refused));
        self.longest = self.longest.max(seconds);
    }
}

/// Files of the problem that inputs with numbers near to each other are made of.
#[derive(Default)]
struct Pool {
    block: Option<usize>,
    files: Vec<Files>,
}

impl Pool {
    /// So many inputs are made of one random problem.
    const INPUTS: usize = 200;

    /// Reader and files of an input.
    fn input(&mut self, options: &Options, number: usize) -> (String, Files) {
        let block = number / Self::INPUTS;
        if self.block != Some(block) {
            let draw = Draw::new(&mut Dice::of(options.seed, block), Scale::Tiny);
            let forms = [Form::Text, Form::Deck, Form::Gmsh].into_iter().filter_map(|form| draw.files(form));
            self.files = forms.chain(options.seeds.iter().cloned()).collect();
            self.block = Some(block);
        }
        let mut random = ChaCha8Rng::seed_from_u64(options.seed);
        random.set_stream(number as u64);
        let mut files = self.files[random.random_range(0..self.files.len())].clone();
        let (which, from) = (random.random_range(0..files.len()), random.random_range(0..self.files.len()));
        let other = &self.files[from][0].1;
        for _ in 0..random.random_range(1..6) {
            damage(&mut files[which].1, other, &mut random);
        }
        let end = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
        let reader = end(&files[which].0);
        let reader = match which {
            0 if files.len() > 1 => format!("{reader} beside {}", end(&files[1].0)),
            _ => reader,
        };
        (reader, files)
    }
}

/// Numbers and words that a reader may not expect.
const ODD: [&str; 35] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3.7",
    "1e-9",
    "1e-320",
    "1e300",
    "1e308",
    "-1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "4294967295",
    "4294967296",
    "-2147483649",
    "9223372036854775807",
    "18446744073709551616",
    "1_0",
    "0x1F",
    "1.D3",
    "true",
    "[]",
    "{}",
    "\"\"",
    "\"",
    "'",
    "[[",
    "*",
    ",,,",
    "\u{0}",
    "é",
    "=",
];

/// One change.
fn damage(bytes: &mut Vec<u8>, other: &[u8], random: &mut ChaCha8Rng) {
    if bytes.is_empty() {
        bytes.extend_from_slice(other);
        return;
    }
    let at = random.random_range(0..bytes.len());
    let span = |random: &mut ChaCha8Rng, bytes: &[u8]| {
        let from = random.random_range(0..bytes.len());
        let most = if random.random_bool(0.9) { 30 } else { bytes.len() };
        from..(from + random.random_range(0..=most)).min(bytes.len())
    };
    match random.random_range(0..10) {
        0 => bytes[at] = random.random(),
        1 => bytes.insert(at, random.random()),
        2 => drop(bytes.drain(span(random, bytes))),
        3 => {
            let piece = bytes[span(random, bytes)].to_vec();
            bytes.splice(at..at, piece);
        }
        4 if !other.is_empty() => {
            let piece = other[span(random, other)].to_vec();
            bytes.splice(at..at, piece);
        }
        5 => {
            // A line goes to another place.
            let from = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
            let to = bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |end| at + end + 1);
            let line: Vec<u8> = bytes.drain(from..to).collect();
            if random.random_bool(0.7) {
                let starts: Vec<usize> = (0..bytes.len()).filter(|&i| bytes[i] == b'\n').map(|i| i + 1).collect();
                let place = if starts.is_empty() { 0 } else { starts[random.random_range(0..starts.len())] };
                bytes.splice(place..place, line);
            }
        }
        6 if random.random_bool(0.1) => bytes.truncate(at),
        _ => {
            // The word at a place, most of which are numbers.
            let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b".-+_".contains(byte);
            let from = bytes[..at].iter().rposition(|byte| !is_part(byte)).map_or(0, |end| end + 1);
            let to = bytes[at..].iter().position(|byte| !is_part(byte)).map_or(bytes.len(), |end| at + end);
            let odd = ODD[random.random_range(0..ODD.len())].as_bytes().to_vec();
            bytes.splice(from..to.max(from), odd);
        }
    }
}

/// Reads an input as the program does, up to what it says of it before it solves.
fn fate(files: &Files) -> Fate {
    let (name, bytes) = &files[0];
    if name.ends_with(".csv") {
        return curve(bytes);
    }
    if name.ends_with(".stl") || name.ends_with(".obj") {
        return surface(name, bytes);
    }
    let refused = |error: pneuflex::Error| {
        let message = error.to_string();
        match message.is_empty() {
            true => Fate::Wrong("it is refused without a word".into()),
            false => Fate::Refused,
        }
    };
    let study = match Study::from_files(name, files.clone()) {
        Ok(study) => study,
        Err(error) => return refused(error),
    };
    let actuator = study.model().and_then(|model| Some((model.actuator.as_ref()?, model.mesh.clone())));
    let elements = match (&actuator, study.estimate()) {
        (_, Some(estimate)) => estimate.elements,
        (Some((actuator, mesh)), None) => {
            let size = mesh.mesh_size(actuator);
            let [x, y, z] = size.size.map(|h| h.min(size.edge));
            actuator.length() * actuator.width * actuator.height / (x * y * z)
        }
        (None, None) => 0.0,
    };
    if !(0.0..FEW).contains(&elements) {
        return Fate::Refused;
    }
    match study.build_within(MemoryLimit::Available) {
        Err(error) => refused(error),
        Ok(analysis) => {
            let described = analysis.overview().to_string();
            let _ = (analysis.cautions(), analysis.resolved());
            if described.contains("NaN") { Fate::Wrong(format!("it is described so: {described}")) } else { Fate::Read }
        }
    }
}

/// A surface of triangles, up to where it would be meshed.
fn surface(name: &str, bytes: &[u8]) -> Fate {
    let Ok(read) = pneuflex::deck::surface::read(name, bytes) else { return Fate::Refused };
    let Ok(bounded) = read.bounded() else { return Fate::Refused };
    let is_refused = !bounded.surface.crossings(3).is_empty();
    match bounded.surface.thinnest_wall() {
        _ if is_refused => Fate::Refused,
        Some(wall) if !(wall.thickness > 0.0 && wall.thickness.is_finite()) => {
            Fate::Wrong("a wall has no thickness".into())
        }
        _ => Fate::Read,
    }
}

/// A curve of a material test.
fn curve(bytes: &[u8]) -> Fate {
    let Ok(text) = decode(bytes) else { return Fate::Refused };
    let Ok(reading) = read("curve.csv", &text, &ReadOptions::default()) else { return Fate::Refused };
    for curve in &reading.curves {
        let points = clean(curve, &Cleaning::default()).used;
        if !points.iter().all(|point| point.stretch.is_finite() && point.stress.is_finite()) {
            return Fate::Wrong("a point is not finite".into());
        }
    }
    Fate::Read
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn damaged_inputs_are_read_or_refused() {
        let curve =
            vec![("a.csv".to_owned(), b"stretch,uniaxial nominal stress (MPa)\n1.1,0.05\n1.2,0.1\n1.4,0.2\n".to_vec())];
        let box_of_triangles = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n".to_vec();
        let seeds = vec![curve, vec![("a.obj".to_owned(), box_of_triangles)]];
        let options = Options { inputs: 1500, seed: 1, seeds };
        let tallies = run(&options, &|fault| panic!("input {}: {}", fault.input, fault.why));
        let (read, refused): (usize, usize) =
            tallies.iter().fold((0, 0), |(read, refused), tally| (read + tally.read, refused + tally.refused));
        assert!(read > 30 && refused > 100 && tallies.len() > 3, "{tallies:?}");
    }
}
