//! Hidden surfaces by a depth buffer.

use pneuflex_mesh::Outline;

use super::colour_map::viridis;
use super::skin::{Face, Skin, triangle_normal};
use super::view::{Camera, Seen};
use crate::drawing::{Colour, Image};
use pneuflex_mesh::vector::{Vec3, dot};
use pneuflex_post::surface::edge_distances;

/// What part of the plane of the picture is shown: x to the right, y up, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub low: [f64; 2],
    pub high: [f64; 2],
}

impl Frame {
    pub const EMPTY: Self = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };

    pub fn with(self, point: [f64; 2]) -> Self {
        Self {
            low: std::array::from_fn(|d| self.low[d].min(point[d])),
            high: std::array::from_fn(|d| self.high[d].max(point[d])),
        }
    }

    pub fn size(&self) -> [f64; 2] {
        std::array::from_fn(|d| self.high[d] - self.low[d])
    }

    pub fn centre(&self) -> [f64; 2] {
        std::array::from_fn(|d| 0.5 * (self.high[d] + self.low[d]))
    }

    /// The same centre and at least this size.
    pub fn grown(self, size: [f64; 2]) -> Self {
        let centre = self.centre();
        let half: [f64; 2] = std::array::from_fn(|d| 0.5 * size[d].max(self.size()[d]));
        Self { low: std::array::from_fn(|d| centre[d] - half[d]), high: std::array::from_fn(|d| centre[d] + half[d]) }
    }
}

/// How the faces are coloured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paint {
    /// Range of the field; `None` for a body without one.
    pub range: Option<[f64; 2]>,
    /// Width of element edges, px; edges of the body are twice as wide.
    pub edge_width: f64,
}

/// Colour of a body without a field.
const PLAIN: Colour = Colour([164, 196, 222]);
/// Colour of obstacles.
const OBSTACLE: Colour = Colour([196, 190, 180]);
/// Colour of places where two parts of the body are at once.
const OVERLAP: Colour = Colour([214, 39, 40]);
/// Two surfaces no further apart than this (mm) and parallel lie in each other.
const SAME_DEPTH: f64 = 1e-3;
/// Samples of a pixel along each direction.
const SAMPLES: usize = 2;
/// Steps of a sample in which corners are placed.
const STEPS: f64 = 256.0;

struct Buffer {
    width: usize,
    height: usize,
    depth: Vec<f32>,
    /// Face seen there, from 1; 0 for none.
    face: Vec<u32>,
    colour: Vec<[u8; 3]>,
    overlaps: Vec<bool>,
}

/// A triangle's corner on the buffer.
#[derive(Clone, Copy)]
struct Corner {
    /// Place in steps.
    at: [i64; 2],
    /// Depth, mm; reference coordinates; value; brightness.
    carried: [f64; 5],
}

/// Draws a skin and obstacles. `scale` is pixels per mm. Where nothing is seen the image is clear.
pub(crate) fn render(
    (skin, obstacles): (&Skin, &[Face]),
    camera: &Camera,
    frame: &Frame,
    scale: f64,
    pixels: [usize; 2],
    paint: &Paint,
) -> Image {
    let [width, height] = pixels.map(|p| p * SAMPLES);
    let count = width * height;
    let mut buffer = Buffer {
        width,
        height,
        depth: vec![f32::INFINITY; count],
        face: vec![0; count],
        colour: vec![[0; 3]; count],
        overlaps: vec![false; count],
    };
    let fine = scale * SAMPLES as f64;
    let faces = || skin.faces.iter().chain(obstacles);
    // Two parts of the body may be at one place by mistake; what lies on an obstacle is where it should be.
    let normal = |f: &Face| if f.is_of_body { f.vertices[f.vertices.len() / 2].normal } else { [0.0; 3] };
    let normals: Vec<Vec3> = faces().map(normal).collect();
    for (number, face) in faces().enumerate() {
        let seen: Vec<Seen> = face.vertices.iter().map(|v| camera.see(v.position)).collect();
        let place = |s: &Seen| {
            let at = [(s.x - frame.low[0]) * fine, (frame.high[1] - s.y) * fine];
            at.map(|x| (x.clamp(-1e6, 1e6) * STEPS).round() as i64)
        };
        for triangle in face.triangles() {
            let positions = triangle.map(|i| face.vertices[i].position);
            let corners = triangle.map(|i| {
                let (vertex, s) = (&face.vertices[i], &seen[i]);
                let light = brightness(camera, vertex.position, vertex.normal);
                let carried = [s.depth, vertex.xi[0], vertex.xi[1], vertex.value, light];
                Corner { at: place(s), carried }
            });
            // Smooth normals may be turned away on a piece that is seen, hence the piece's own.
            let own = triangle_normal(positions);
            let sign = if dot(own, face.vertices[triangle[0]].normal) < 0.0 { -1.0 } else { 1.0 };
            let is_front = sign * dot(own, camera.toward(positions[0])) > 0.0;
            // From behind a plane one looks through it.
            if !is_front && !face.is_of_body {
                continue;
            }
            buffer
                .fill(corners, number, is_front, &normals, |carried, gradients| shade(face, carried, gradients, paint));
        }
    }
    buffer.image(pixels)
}

fn brightness(camera: &Camera, position: Vec3, normal: Vec3) -> f64 {
    // A face seen from behind is lit from behind: there is none in a closed body, so this shows a wrong one no better.
    let sign = if dot(normal, camera.toward(position)) < 0.0 { -1.0 } else { 1.0 };
    0.7 + 0.3 * (sign * dot(normal, camera.lamp())).max(0.0)
}

/// Colour of a sample; `gradients` are those of the reference coordinates per sample.
fn shade(face: &Face, carried: [f64; 5], gradients: [[f64; 2]; 2], paint: &Paint) -> [u8; 3] {
    let [_, xi, eta, value, light] = carried;
    let base = match paint.range {
        _ if !face.is_of_body => OBSTACLE,
        Some([low, high]) => viridis((value - low) / (high - low).max(f64::MIN_POSITIVE)),
        None => PLAIN,
    };
    let mut colour = Colour::BLACK.towards(base, light);
    let norm = |g: [f64; 2]| (g[0] * g[0] + g[1] * g[1]).sqrt().max(1e-12);
    let [per_xi, per_eta] = gradients.map(norm);
    // Distance from the sides of the face in samples: reference distance over its change per sample.
    let (per_edge, width) = match face.kind.outline {
        Outline::Triangle => {
            let per_sum = norm(std::array::from_fn(|k| gradients[0][k] + gradients[1][k]));
            ([per_eta, per_sum, per_xi, 1.0], 1.0)
        }
        Outline::Square => ([per_eta, per_xi, per_eta, per_xi], 2.0),
    };
    let reference = edge_distances(face.kind, [xi, eta]);
    let distance: [f64; 4] = std::array::from_fn(|edge| reference[edge] / per_edge[edge]);
    // Lines of small elements fade, lest they cover the colours.
    let smallest = (width / per_xi).min(width / per_eta) / SAMPLES as f64;
    let fade = ((smallest - 2.0) / 8.0).clamp(0.0, 1.0);
    let half = 0.5 * paint.edge_width * SAMPLES as f64;
    let mut line: f64 = 0.0;
    for (distance, is_edge) in distance.into_iter().zip(face.is_edge) {
        let inner = if face.is_of_body { 0.45 * fade } else { 0.0 };
        let (width, strength) = if is_edge { (2.0 * half, 0.8) } else { (half, inner) };
        line = line.max(strength * (width + 0.5 - distance).clamp(0.0, 1.0));
    }
    colour = colour.towards(Colour::BLACK, line);
    colour.0
}

impl Buffer {
    fn fill(
        &mut self,
        mut corners: [Corner; 3],
        number: usize,
        is_front: bool,
        normals: &[Vec3],
        shade: impl Fn([f64; 5], [[f64; 2]; 2]) -> [u8; 3],
    ) {
        let edge =
            |a: [i64; 2], b: [i64; 2], p: [i64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        let mut area = edge(corners[0].at, corners[1].at, corners[2].at);
        if area == 0 {
            return;
        }
        if area < 0 {
            corners.swap(1, 2);
            area = -area;
        }
        let [a, b, c] = corners;
        let step = STEPS as i64;
        let range = |d: usize, limit: usize| {
            let (low, high) = (a.at[d].min(b.at[d]).min(c.at[d]), a.at[d].max(b.at[d]).max(c.at[d]));
            let first = low.div_euclid(step).clamp(0, limit as i64);
            let last = (high.div_euclid(step) + 1).clamp(0, limit as i64);
            first..last
        };
        // A sample on a side shared by two triangles belongs to one of them: the one it is the left or upper side of.
        let bias = |p: [i64; 2], q: [i64; 2]| {
            let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
            i64::from(!(dy < 0 || (dy == 0 && dx > 0)))
        };
        let biases = [bias(b.at, c.at), bias(c.at, a.at), bias(a.at, b.at)];
        let gradient = |k: usize| {
            let [p, q, r] = [a, b, c].map(|v| (v.at.map(|x| x as f64 / STEPS), v.carried[k]));
            let (dx1, dy1, d1) = (q.0[0] - p.0[0], q.0[1] - p.0[1], q.1 - p.1);
            let (dx2, dy2, d2) = (r.0[0] - p.0[0], r.0[1] - p.0[1], r.1 - p.1);
            let det = dx1 * dy2 - dx2 * dy1;
            [(d1 * dy2 - d2 * dy1) / det, (dx1 * d2 - dx2 * d1) / det]
        };
        let gradients = [gradient(1), gradient(2)];
        for row in range(1, self.height) {
            for column in range(0, self.width) {
                let p = [column * step + step / 2, row * step + step / 2];
                let weights = [edge(b.at, c.at, p), edge(c.at, a.at, p), edge(a.at, b.at, p)];
                if (0..3).any(|i| weights[i] < biases[i]) {
                    continue;
                }
                let w = weights.map(|w| w as f64 / area as f64);
                let carried: [f64; 5] =
                    std::array::from_fn(|k| w[0] * a.carried[k] + w[1] * b.carried[k] + w[2] * c.carried[k]);
                let place = row as usize * self.width + column as usize;
                let (depth, there) = (carried[0] as f32, self.depth[place]);
                let other = self.face[place] as usize;
                if is_front && other > 0 && other != number + 1 {
                    let is_same = f64::from((depth - there).abs()) < SAME_DEPTH;
                    if is_same && dot(normals[other - 1], normals[number]) > 0.999 {
                        self.overlaps[place] = true;
                        continue;
                    }
                }
                if depth < there {
                    self.depth[place] = depth;
                    self.face[place] = number as u32 + 1;
                    self.colour[place] = shade(carried, gradients);
                    self.overlaps[place] = false;
                }
            }
        }
    }

    /// Means of the samples of every pixel.
    fn image(&self, [width, height]: [usize; 2]) -> Image {
        let mut rgba = Vec::with_capacity(4 * width * height);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut covered) = ([0_u32; 3], 0_u32);
                for j in 0..SAMPLES {
                    for i in 0..SAMPLES {
                        let (column, row) = (SAMPLES * x + i, SAMPLES * y + j);
                        let place = row * self.width + column;
                        if self.face[place] == 0 {
                            continue;
                        }
                        covered += 1;
                        let mut colour = Colour(self.colour[place]);
                        if self.overlaps[place] {
                            colour = colour.towards(OVERLAP, 0.85);
                        }
                        for k in 0..3 {
                            sum[k] += u32::from(colour.0[k]);
                        }
                    }
                }
                let all = (SAMPLES * SAMPLES) as u32;
                rgba.extend(sum.map(|s| (s / covered.max(1)) as u8));
                rgba.push((255 * covered / all) as u8);
            }
        }
        Image { width, height, rgba }
    }
}
