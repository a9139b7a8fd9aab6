//! `.stl` and `.obj` files → points and triangles. Points at the same place are one.

use std::collections::BTreeMap;

use super::Surface;
use crate::report::{DeckError, quoted};
use crate::syntax::real;

/// Bytes before the triangles of a binary `.stl`, and of each of them.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Reads a file called `name` from its bytes: `.obj` by that ending, else `.stl`.
///
/// # Errors
/// What is wrong with it.
pub fn read(name: &str, bytes: &[u8]) -> Result<Surface, DeckError> {
    let wrong = |(line, text): (u32, String)| DeckError { file: name.to_owned(), line, text };
    let is_obj = name.to_ascii_lowercase().ends_with(".obj");
    let surface = if is_obj { obj(bytes) } else { stl(bytes) }.map_err(wrong)?;
    if surface.triangles.is_empty() { Err(wrong((1, "the file has no triangle".into()))) } else { Ok(surface) }
}

type Wrong = (u32, String);

fn stl(bytes: &[u8]) -> Result<Surface, Wrong> {
    let announced = bytes.get(80..HEAD).and_then(|bytes| bytes.try_into().ok()).map(u32::from_le_bytes);
    let is_binary =
        |count: &u32| (*count as usize).checked_mul(TRIANGLE).is_some_and(|size| HEAD + size == bytes.len());
    if announced.as_ref().is_some_and(is_binary) {
        return binary(&bytes[HEAD..]);
    }
    if !bytes.trim_ascii_start().starts_with(b"solid") {
        return Err((1, "it is neither text nor binary STL: a text begins with solid, and the length of the file is not that of its number of triangles".into()));
    }
    let mut points = Points::default();
    let mut corners = Vec::new();
    for (line, text) in (1..).zip(bytes.split(|byte| *byte == b'\n')) {
        let text = std::str::from_utf8(text).unwrap_or("\u{fffd}");
        let mut words = text.split_whitespace();
        if words.next() == Some("vertex") {
            corners.push(points.number(position(words).map_err(|why| (line, why))?));
        }
    }
    if corners.len() % 3 != 0 {
        return Err((1, "the file ends within a triangle".into()));
    }
    let triangles = corners.as_chunks::<3>().0.iter().copied().filter(has_three).collect();
    Ok(Surface { points: points.positions, triangles })
}

fn binary(triangles: &[u8]) -> Result<Surface, Wrong> {
    let mut points = Points::default();
    let mut found = Vec::with_capacity(triangles.len() / TRIANGLE);
    for bytes in triangles.chunks_exact(TRIANGLE) {
        let mut corners = [0; 3];
        for (corner, bytes) in corners.iter_mut().zip(bytes[12..48].chunks_exact(12)) {
            let number = |d: usize| {
                let bytes = bytes[4 * d..4 * d + 4].try_into().unwrap_or_default();
                f64::from(f32::from_le_bytes(bytes))
            };
            let x = [0, 1, 2].map(number);
            if !x.iter().all(|t| t.is_finite()) {
                return Err((1, format!("triangle {} has a corner that is no position", found.len() + 1)));
            }
            *corner = points.number(x);
        }
        found.extend(Some(corners).filter(has_three));
    }
    Ok(Surface { points: points.positions, triangles: found })
}

fn obj(bytes: &[u8]) -> Result<Surface, Wrong> {
    let mut points = Points::default();
    // Numbers of the file's points among those at different places.
    let mut numbers: Vec<u32> = Vec::new();
    let mut triangles = Vec::new();
    for (line, text) in (1..).zip(bytes.split(|byte| *byte == b'\n')) {
        let text = std::str::from_utf8(text).unwrap_or("\u{fffd}");
        let mut words = text.split_whitespace();
        match words.next() {
            Some("v") => numbers.push(points.number(position(words).map_err(|why| (line, why))?)),
            Some("f") => {
                let corner = |word: &str| {
                    let first = word.split('/').next().unwrap_or_default();
                    let wrong = || (line, format!("{} is the number of no point before it", quoted(first)));
                    let number: i64 = first.parse().map_err(|_| wrong())?;
                    // From 1, or back from the last one.
                    let at = if number < 0 { numbers.len() as i64 + number } else { number - 1 };
                    usize::try_from(at).ok().and_then(|at| numbers.get(at).copied()).ok_or_else(wrong)
                };
                let corners: Vec<u32> = words.map(corner).collect::<Result<_, _>>()?;
                if corners.len() < 3 {
                    return Err((line, "a face has three corners or more".into()));
                }
                triangles.extend(corners[1..].windows(2).map(|two| [corners[0], two[0], two[1]]).filter(has_three));
            }
            _ => {}
        }
    }
    Ok(Surface { points: points.positions, triangles })
}

fn position<'a>(mut words: impl Iterator<Item = &'a str>) -> Result<[f64; 3], String> {
    let mut x = [0.0; 3];
    for coordinate in &mut x {
        *coordinate = real(words.next().ok_or("a point has three coordinates")?)?;
    }
    Ok(x)
}

fn has_three([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Points at different places.
#[derive(Default)]
struct Points {
    positions: Vec<[f64; 3]>,
    numbers: BTreeMap<[u64; 3], u32>,
}

impl Points {
    fn number(&mut self, x: [f64; 3]) -> u32 {
        // Both zeros are one.
        let key = x.map(|t| (t + 0.0).to_bits());
        *self.numbers.entry(key).or_insert_with(|| {
            self.positions.push(x);
            self.positions.len() as u32 - 1
        })
    }
}
