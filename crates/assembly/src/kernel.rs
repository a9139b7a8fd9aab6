//! The innermost loops of the solid's tangent, over node pairs.
//!
//! Nodes are grouped into lanes of four that the compiler turns into vector instructions; `C` is the number of groups,
//! ⌈N/4⌉. Lanes beyond the last node hold zeros. With `FMA`, products are added by fused instructions, which only pays where
//! the processor has them.

use pneuflex_mesh::mesh::{cofactor, determinant};

/// Nodes handled together.
pub use crate::formulation::LANES;

/// A number for every node.
pub type Lanes<const C: usize> = [[f64; LANES]; C];

/// A vector for every node, component by component.
pub type NodeVectors<const C: usize> = [Lanes<C>; 3];

/// Sum of 3 × 3 blocks: entry (i, j) of the block of nodes a and b stands at `[a][b / 4][3 j + i][b % 4]`. Only b ≤ a counts.
pub type PairBlocks<const N: usize, const C: usize> = [[[[f64; LANES]; 9]; C]; N];

/// Second derivatives of the energy at a point, times its volume.
#[derive(Clone, Copy, Debug, Default)]
pub struct PointTangent {
    /// Factor of (∇N_a·∇N_b) 1.
    pub identity: f64,
    /// Factors of f fᵀ, of f cᵀ + c fᵀ and of c cᵀ.
    pub outer: [f64; 3],
    /// Factor of −\[F (∇N_a × ∇N_b)\]ₓ.
    pub skew: f64,
}

#[inline(always)]
fn add<const FMA: bool>(sum: f64, a: f64, b: f64) -> f64 {
    if FMA { a.mul_add(b, sum) } else { sum + a * b }
}

#[inline(always)]
fn at<const C: usize>(vectors: &NodeVectors<C>, a: usize) -> [f64; 3] {
    let (group, lane) = (a / LANES, a % LANES);
    [vectors[0][group][lane], vectors[1][group][lane], vectors[2][group][lane]]
}

/// Node vectors side by side.
#[inline(always)]
pub fn to_lanes<const N: usize, const C: usize>(vectors: &[[f64; 3]; N]) -> NodeVectors<C> {
    let mut lanes = zero::<C>();
    for a in 0..N {
        for k in 0..3 {
            lanes[k][a / LANES][a % LANES] = vectors[a][k];
        }
    }
    lanes
}

/// Node vectors with the zero vector at every node.
pub const fn zero<const C: usize>() -> NodeVectors<C> {
    [[[0.0; LANES]; C]; 3]
}

/// Σ over nodes of v wᵀ: `[i][j] = Σ vᵢ wⱼ`.
#[inline(always)]
fn contract<const C: usize, const FMA: bool>(v: &NodeVectors<C>, w: [&[[f64; LANES]]; 3]) -> [[f64; 3]; 3] {
    let mut out = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            let mut sum = [0.0; LANES];
            for c in 0..C {
                for l in 0..LANES {
                    sum[l] = add::<FMA>(sum[l], v[i][c][l], w[j][c][l]);
                }
            }
            out[i][j] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
        }
    }
    out
}

/// Gradient `[i][j] = ∂uᵢ/∂Xⱼ` of a field with nodal values `u`, from the shape functions' gradients `g`.
#[inline(always)]
pub fn gradient_of<const C: usize, const FMA: bool>(u: &NodeVectors<C>, g: &NodeVectors<C>) -> [[f64; 3]; 3] {
    contract::<C, FMA>(u, [&g[0], &g[1], &g[2]])
}

/// Gradients ∂N/∂X of an element with reference node positions `x` and det ∂X/∂ξ, from a table of ∂N/∂ξ: direction by
/// direction, `C` groups each.
#[inline(always)]
pub fn geometry<const C: usize, const FMA: bool>(table: &[[f64; LANES]], x: &NodeVectors<C>) -> (NodeVectors<C>, f64) {
    // One check of the length here spares those inside the loops.
    let table = &table[..3 * C];
    let jacobian = contract::<C, FMA>(x, [&table[..C], &table[C..2 * C], &table[2 * C..]]);
    // ∇N = J⁻ᵀ ∂N/∂ξ = cof(J) ∂N/∂ξ / det J.
    let (cof, det) = (cofactor(&jacobian), determinant(&jacobian));
    let (mut scaled, mut gradients) = (cof, zero::<C>());
    for i in 0..3 {
        for j in 0..3 {
            scaled[i][j] /= det;
        }
    }
    for k in 0..3 {
        for c in 0..C {
            gradients[k][c] = table[k * C + c];
        }
    }
    (transform::<C, FMA>(&scaled, &gradients), det)
}

/// v ← v + factor w.
#[inline(always)]
pub fn add_scaled<const C: usize, const FMA: bool>(v: &mut NodeVectors<C>, factor: f64, w: &NodeVectors<C>) {
    for k in 0..3 {
        for c in 0..C {
            for l in 0..LANES {
                v[k][c][l] = add::<FMA>(v[k][c][l], factor, w[k][c][l]);
            }
        }
    }
}

/// Σ over nodes of v·w.
#[inline(always)]
pub fn inner<const C: usize>(v: &NodeVectors<C>, w: &NodeVectors<C>) -> f64 {
    v.as_flattened().as_flattened().iter().zip(w.as_flattened().as_flattened()).map(|(a, b)| a * b).sum()
}

/// M v for every node.
#[inline(always)]
pub fn transform<const C: usize, const FMA: bool>(m: &[[f64; 3]; 3], v: &NodeVectors<C>) -> NodeVectors<C> {
    let mut out = zero::<C>();
    for i in 0..3 {
        for c in 0..C {
            for l in 0..LANES {
                out[i][c][l] = add::<FMA>(add::<FMA>(m[i][0] * v[0][c][l], m[i][1], v[1][c][l]), m[i][2], v[2][c][l]);
            }
        }
    }
    out
}

/// Adds the tangent of one point, with g = ∇N, f = F g, c = cof F g and the deformation gradient F.
#[inline(always)]
pub fn add_point<const N: usize, const C: usize, const FMA: bool>(
    sum: &mut PairBlocks<N, C>,
    [g, f, c]: [&NodeVectors<C>; 3],
    deformation: &[[f64; 3]; 3],
    tangent: &PointTangent,
) {
    let [ff, fc, cc] = tangent.outer;
    let (mut p, mut q): (NodeVectors<C>, NodeVectors<C>) = (zero(), zero());
    for k in 0..3 {
        for i in 0..C {
            for l in 0..LANES {
                p[k][i][l] = add::<FMA>(ff * f[k][i][l], fc, c[k][i][l]);
                q[k][i][l] = add::<FMA>(fc * f[k][i][l], cc, c[k][i][l]);
            }
        }
    }
    for a in 0..N {
        let (ga, fa, ca) = (at(g, a), at(f, a), at(c, a));
        let gi = [tangent.identity * ga[0], tangent.identity * ga[1], tangent.identity * ga[2]];
        // F (g_a × g_b) = (F [g_a]ₓ) g_b, with the factor.
        let cross = [[0.0, -ga[2], ga[1]], [ga[2], 0.0, -ga[0]], [-ga[1], ga[0], 0.0]];
        let mut m = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                for k in 0..3 {
                    m[i][j] = add::<FMA>(m[i][j], tangent.skew * deformation[i][k], cross[k][j]);
                }
            }
        }
        for i in 0..=a / LANES {
            let block = &mut sum[a][i];
            for l in 0..LANES {
                let gb = [g[0][i][l], g[1][i][l], g[2][i][l]];
                let product = add::<FMA>(add::<FMA>(gi[0] * gb[0], gi[1], gb[1]), gi[2], gb[2]);
                let mut v = [0.0; 3];
                for k in 0..3 {
                    v[k] = add::<FMA>(add::<FMA>(m[k][0] * gb[0], m[k][1], gb[1]), m[k][2], gb[2]);
                }
                // Columns of product · 1 − [v]ₓ.
                let rest = [product, -v[2], v[1], v[2], product, -v[0], -v[1], v[0], product];
                for j in 0..3 {
                    for k in 0..3 {
                        let old = block[3 * j + k][l] + rest[3 * j + k];
                        block[3 * j + k][l] = add::<FMA>(add::<FMA>(old, fa[k], p[j][i][l]), ca[k], q[j][i][l]);
                    }
                }
            }
        }
    }
}

/// Adds −\[v\]ₓ alone, for points that have no other share in the tangent.
#[inline(always)]
pub fn add_skew<const N: usize, const C: usize, const FMA: bool>(
    sum: &mut PairBlocks<N, C>,
    g: &NodeVectors<C>,
    deformation: &[[f64; 3]; 3],
    skew: f64,
) {
    let none = zero::<C>();
    add_point::<N, C, FMA>(sum, [g, &none, &none], deformation, &PointTangent { skew, ..PointTangent::default() });
}

/// Adds ∇N_a · A · ∇N_b for every pair of nodes, A being the second derivative of the energy by F: row and column 3i + j belong
/// to ∂rᵢ/∂Xⱼ.
#[inline(always)]
pub fn add_moduli<const N: usize, const C: usize, const FMA: bool>(
    sum: &mut PairBlocks<N, C>,
    g: &NodeVectors<C>,
    moduli: &[[f64; 9]; 9],
) {
    for a in 0..N {
        let ga = at(g, a);
        // Row i of ∇N_a · A.
        let mut m = [[0.0; 9]; 3];
        for i in 0..3 {
            for k in 0..9 {
                for j in 0..3 {
                    m[i][k] = add::<FMA>(m[i][k], ga[j], moduli[3 * i + j][k]);
                }
            }
        }
        for c in 0..=a / LANES {
            let block = &mut sum[a][c];
            for l in 0..LANES {
                let gb = [g[0][c][l], g[1][c][l], g[2][c][l]];
                for k in 0..3 {
                    for i in 0..3 {
                        let mut entry = block[3 * k + i][l];
                        for n in 0..3 {
                            entry = add::<FMA>(entry, m[i][3 * k + n], gb[n]);
                        }
                        block[3 * k + i][l] = entry;
                    }
                }
            }
        }
    }
}

/// Adds b wᵀ for every pair of nodes.
#[inline(always)]
pub fn add_outer<const N: usize, const C: usize, const FMA: bool>(
    sum: &mut PairBlocks<N, C>,
    b: &NodeVectors<C>,
    w: &NodeVectors<C>,
) {
    for a in 0..N {
        let ba = at(b, a);
        for i in 0..=a / LANES {
            let block = &mut sum[a][i];
            for l in 0..LANES {
                for j in 0..3 {
                    for k in 0..3 {
                        block[3 * j + k][l] = add::<FMA>(block[3 * j + k][l], ba[k], w[j][i][l]);
                    }
                }
            }
        }
    }
}

/// Adds the sums to the blocks of a tangent, pair by pair.
#[inline(always)]
pub fn store<const N: usize, const C: usize>(sum: &PairBlocks<N, C>, tangent: &mut [[f64; 9]]) {
    let mut pairs = tangent.iter_mut();
    for (a, row) in sum.iter().enumerate() {
        for b in 0..=a {
            if let Some(block) = pairs.next() {
                for k in 0..9 {
                    block[k] += row[b / LANES][k][b % LANES];
                }
            }
        }
    }
}
