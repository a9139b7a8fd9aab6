//! The page that shows what would be solved, before it is: the body, and on it cavities, supports, loads, surfaces that may touch, regions.

use maud::html;
use pneuflex_mesh::{Facet, Mesh};
use serde::Serialize;

use crate::body::Body;
use crate::controls::stage;
use crate::error::ReportError;
use crate::page::document;
use crate::payload::{centre, for_script};
use crate::quantise::floats;
use crate::regions::Regions;
use crate::skin::Skin;

/// What would be solved.
#[derive(Clone, Debug)]
pub struct Setup<'a> {
    /// Title of the problem.
    pub title: &'a str,
    /// What the body is, in a few words.
    pub about: &'a str,
    /// The body.
    pub mesh: &'a Mesh,
    /// What is on it, in the order in which it is listed.
    pub parts: Vec<Part>,
}

/// Something on the body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// What kind of thing it is, e.g. `support`.
    pub kind: &'static str,
    /// Its name, with what else is to be said of it.
    pub name: String,
    /// Its faces.
    pub facets: Vec<Facet>,
    /// Its nodes, drawn as dots.
    pub nodes: Vec<u32>,
    /// Triangles that are none of the body's, mm.
    pub triangles: Vec<[[f64; 3]; 3]>,
}

#[derive(Serialize)]
struct Data {
    body: String,
    /// Both ends of the sharp edges.
    edges: String,
    parts: Vec<PartData>,
}

#[derive(Serialize)]
struct PartData {
    triangles: String,
    points: String,
}

impl Part {
    fn count(&self) -> String {
        let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
        match (self.facets.len(), self.nodes.len()) {
            (0, 0) if !self.triangles.is_empty() => String::new(),
            (0, nodes) => count(nodes, "node"),
            (faces, _) => count(faces, "face"),
        }
    }
}

/// The page as the text of an HTML file. The same setup always gives the same text.
///
/// # Errors
/// Data that cannot be written as JSON.
pub fn render(setup: &Setup<'_>) -> Result<String, ReportError> {
    let Setup { title, about, mesh, parts } = setup;
    let origin = centre(&mesh.nodes);
    let place = |node: u32| std::array::from_fn::<f64, 3, _>(|d| mesh.nodes[node as usize][d] - origin[d]);
    let points = |nodes: &mut dyn Iterator<Item = u32>| floats(&nodes.flat_map(place).collect::<Vec<f64>>());
    let skin = Skin::new(mesh, &[], &[], &Regions::default(), &Body::new(mesh));
    let data = Data {
        body: points(&mut mesh.boundary_facets().iter().flat_map(|&facet| corners_of_triangles(mesh, facet))),
        // Edges of the body as it is drawn may run over nodes that the mesh lacks.
        edges: points(
            &mut skin.sharp_edges.pairs.iter().flatten().copied().filter(|&n| (n as usize) < mesh.num_nodes()),
        ),
        parts: (parts.iter())
            .map(|part| PartData {
                triangles: if part.triangles.is_empty() {
                    points(&mut part.facets.iter().flat_map(|&facet| corners_of_triangles(mesh, facet)))
                } else {
                    let corners = part.triangles.as_flattened().iter();
                    floats(&corners.flat_map(|x| [0, 1, 2].map(|d| x[d] - origin[d])).collect::<Vec<f64>>())
                },
                points: points(&mut part.nodes.iter().copied()),
            })
            .collect(),
    };
    let data = for_script(&serde_json::to_string(&data).map_err(|e| ReportError::Json(e.to_string()))?);
    let title = if title.is_empty() { about } else { title };
    let body = html! {
        header .masthead { div .titles { h1 { (title) } p { (about) @if !about.is_empty() { " · " } "before it is solved" } } }
        main {
            div .dashboard {
                section .viewer aria-label="The body in three dimensions" { (stage("body", false)) }
                section #parts .parts aria-label="What is on the body" {
                    @for (number, part) in parts.iter().enumerate() {
                        label .part {
                            input type="checkbox" checked data-part=(number);
                            span .swatch {}
                            span { strong { (part.kind) } " " (part.name) }
                            span .count { (part.count()) }
                        }
                    }
                }
            }
        }
    };
    Ok(document(&format!("{title} – pneuflex check"), &body, &data, "setup"))
}

/// A face as triangles between its corners.
fn corners_of_triangles(mesh: &Mesh, facet: Facet) -> Vec<u32> {
    let (nodes, corners) = (mesh.facet_nodes(facet), mesh.face_kind(facet).num_corners());
    (2..corners).flat_map(|i| [nodes[0], nodes[i - 1], nodes[i]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::two_chambers;
    use pneuflex_model::Formulation;

    #[test]
    fn parts_are_listed_with_their_faces_and_text_never_becomes_markup() {
        let problem = two_chambers(Formulation::Hex20);
        let facets = problem.cavities[0].facets.clone();
        let parts = vec![
            Part { kind: "cavity", name: "<b>air".into(), facets: facets.clone(), ..Part::default() },
            Part { kind: "support", name: "clamp".into(), nodes: vec![0], ..Part::default() },
        ];
        let setup = Setup { title: "</script><i>", about: "a case", mesh: &problem.mesh, parts };
        let html = render(&setup).unwrap();
        assert_eq!(html, render(&setup).unwrap());
        assert!(!html.contains("<b>") && !html.contains("<i>") && html.matches("</script>").count() == 3);
        assert!(html.contains(&format!("{} faces", facets.len())) && html.contains("1 node<"));
        let data = html.split("application/json\">").nth(1).unwrap().split("</script>").next().unwrap();
        let data: serde_json::Value = serde_json::from_str(data).unwrap();
        // Two triangles of three corners with three numbers of four bytes, three bytes in four characters.
        assert_eq!(data["parts"][0]["triangles"].as_str().unwrap().len(), facets.len() * 2 * 3 * 3 * 4 / 3 * 4);
    }
}
