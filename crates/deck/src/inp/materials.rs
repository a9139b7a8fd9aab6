//! Materials and the elements that are made of them.

use std::collections::BTreeMap;

use pneuflex_model::Material;

use super::body::Body;
use super::constants::Constants;
use super::context::Context;
use super::outline::{Item, Outline};
use super::sets::AllSets;
use crate::deck::Extent;
use crate::report::{Place, quoted, suggestion};

/// The least ratio of bulk to shear modulus that is used for a material that is meant to be incompressible: Poisson's ratio 0.4995.
const NEARLY_INCOMPRESSIBLE: f64 = 1000.0;

/// A material of the deck.
#[derive(Debug)]
pub(super) struct NamedMaterial {
    /// As it is written.
    pub name: String,
    pub constants: Option<Constants>,
    /// t/mm³.
    pub density: Option<f64>,
}

/// Elements of one material, in ascending order.
#[derive(Debug)]
pub(super) struct Section {
    pub material: usize,
    pub elements: Vec<u32>,
    pub place: Place,
}

/// Materials, and sections with at least one element each that together hold every element once.
#[derive(Debug, Default)]
pub(super) struct Materials {
    pub list: Vec<NamedMaterial>,
    pub sections: Vec<Section>,
}

impl Materials {
    pub fn read(outline: &Outline<'_>, body: &Body, sets: &AllSets, extent: Extent, context: &mut Context<'_>) -> Self {
        let mut list: Vec<NamedMaterial> = Vec::new();
        let mut by_name: BTreeMap<String, usize> = BTreeMap::new();
        for (number, item) in outline.items.iter().enumerate() {
            if item.block.keyword != "MATERIAL" {
                continue;
            }
            let Some(name) = context.required(item.block, "NAME") else { continue };
            if by_name.insert(name.to_uppercase(), list.len()).is_some() {
                context.error(item.block.place, format!("material {} is there twice", quoted(name)));
            }
            let owned: Vec<Item<'_>> =
                outline.items.iter().copied().filter(|item| item.owner == Some(number)).collect();
            list.push(read_material(name, item.block.place, &owned, context));
        }
        let mut materials = Self { list, sections: Vec::new() };
        if extent == Extent::Problem || outline.of("SOLIDSECTION").next().is_some() {
            materials.read_sections(outline, &by_name, body, sets, context);
        }
        materials
    }

    fn read_sections(
        &mut self,
        outline: &Outline<'_>,
        by_name: &BTreeMap<String, usize>,
        body: &Body,
        sets: &AllSets,
        context: &mut Context<'_>,
    ) {
        let mut section_of: Vec<Option<Place>> = vec![None; body.mesh.num_elements()];
        for Item { block, scope, .. } in outline.of("SOLIDSECTION") {
            let (Some(elements), Some(name)) = (context.required(block, "ELSET"), context.required(block, "MATERIAL"))
            else {
                continue;
            };
            let material = by_name.get(&name.to_uppercase()).copied();
            if material.is_none() {
                let hint = suggestion(name, self.list.iter().map(|material| material.name.as_str()));
                context.error(block.place, format!("there is no material {}{hint}", quoted(name)));
            }
            let members = match sets.elements.get(body, scope, elements, "element set") {
                Ok(set) => &set.members,
                Err(why) => {
                    context.error(block.place, format!("{}: {why}", block.written));
                    continue;
                }
            };
            for &element in members {
                if let Some(first) = section_of[element as usize].replace(block.place) {
                    let text =
                        format!("element {} has a section already, in line {}", body.element_name(element), first.line);
                    context.error(block.place, text);
                    break;
                }
            }
            if let (Some(material), false) = (material, members.is_empty()) {
                self.sections.push(Section { material, elements: members.clone(), place: block.place });
            }
        }
        let without: Vec<u32> =
            (0..section_of.len() as u32).filter(|&element| section_of[element as usize].is_none()).collect();
        if let Some(&first) = without.first() {
            let (name, place) = (body.element_name(first), body.element_places[first as usize]);
            let others = if without.len() > 1 { format!(" (and {} others)", without.len() - 1) } else { String::new() };
            context.error(place, format!("element {name}{others} has no *SOLID SECTION"));
        }
        for section in &self.sections {
            let NamedMaterial { name, constants, .. } = &self.list[section.material];
            if constants.is_none() && !context.report.has_errors() {
                context.error(section.place, format!("material {} has no law", quoted(name)));
            }
        }
    }
}

fn read_material(name: &str, place: Place, owned: &[Item<'_>], context: &mut Context<'_>) -> NamedMaterial {
    let mut material = NamedMaterial { name: name.to_owned(), constants: None, density: None };
    let mut has_law = false;
    for Item { block, .. } in owned {
        if block.keyword == "DENSITY" {
            match context.numbers(block).as_deref() {
                Some(&[density] | &[density, _]) if density > 0.0 && block.lines.len() == 1 => {
                    material.density = Some(density);
                }
                Some(_) => context.error(block.place, "*DENSITY takes one number greater than 0"),
                None => {}
            }
            continue;
        }
        if std::mem::replace(&mut has_law, true) {
            context.error(block.place, format!("material {} has two laws", quoted(name)));
        }
        material.constants = Constants::read(block, context);
    }
    if !has_law {
        context.error(place, format!("material {} has no *HYPERELASTIC and no *ELASTIC", quoted(name)));
    }
    material
}

impl NamedMaterial {
    /// For the solver; `None` if its law was refused.
    pub fn for_solver(&self, place: Place, context: &mut Context<'_>) -> Option<Material> {
        let constants = self.constants.as_ref()?;
        let shear_modulus = constants.law.shear_modulus();
        let bulk_modulus = constants.bulk_modulus.unwrap_or_else(|| {
            let bulk = NEARLY_INCOMPRESSIBLE * shear_modulus;
            let text = format!(
                "material {}: D1 is 0 or left out, and the bulk modulus {bulk:.6} MPa is taken, {NEARLY_INCOMPRESSIBLE} times the shear modulus \
                 (CalculiX takes 20 times, Abaqus an incompressible material with hybrid elements, else 20 times)",
                quoted(&self.name)
            );
            context.note(place, text);
            bulk
        });
        // Densities of the model are in g/cm³.
        let density = self.density.unwrap_or(0.0) * 1e9;
        let material = Material { bulk_modulus, density, ..Material::from(constants.law.clone()) };
        for problem in material.problems(&self.name) {
            context.error(place, format!("material {problem}"));
        }
        Some(material)
    }
}
