//! What the pages of other bodies have to show.

use std::path::Path;

use serde_json::{Value, json};

use super::Results;
use super::browser::Browser;
use super::visit::{Screen, Visit, distance, expect, open};

/// Opens the report of the two blocks of `fixtures/decks` on a screen: the same page with the time in place of the pressure.
///
/// # Errors
/// The first thing that is not as it should be.
pub fn look_at_blocks(
    browser: &mut Browser,
    screen: &Screen,
    results: &Results,
    pictures: &Path,
) -> Result<(), String> {
    let mut visit = Visit { browser, screen, results, pictures };
    visit.open()?;
    visit.picture("7-blocks")?;
    let said = [visit.text("#time-readout")?, visit.text("#origin")?, visit.text("#ticks")?].join(" ");
    expect(said.split_whitespace().eq(["time", "1.00", "computed", "0", "1"]), || format!("the slider says {said:?}"))?;
    let plots = visit.text_of_plots()?;
    let force = results.summary["steps"][0]["reactions"]["RAM"].as_array().ok_or("no reaction of the ram")?;
    let force = force.iter().filter_map(Value::as_f64).map(|f| f * f).sum::<f64>().sqrt();
    expect(plots.contains(&format!("RAM\n{force:.2} N")) && !plots.contains("Bending"), || format!("plots: {plots}"))?;

    visit.browser.evaluate("document.getElementById('time').scrollIntoView({block: 'center'})")?;
    let [left, top, width, height] = visit.area("#time")?;
    let at = |share: f64| [left + 10.0 + share * (width - 20.0), top + height / 2.0];
    visit.browser.drag(&[at(1.0), at(0.8), at(0.5)])?;
    let time = visit.browser.numbers("[pneuflex.time]")?[0];
    let origin = visit.text("#origin")?;
    expect((time - 0.5).abs() < 0.05 && origin == "interpolated between 0 and 1", || {
        format!("the slider was dragged to {time}: {origin}")
    })?;
    // In the middle of the view there is something to read, at half the way of the ram.
    visit.browser.evaluate("document.getElementById('stage').scrollIntoView({block: 'center'})")?;
    let [left, top, width, height] = visit.area("#canvas")?;
    visit.press([left + width / 2.0, top + height / 2.0])?;
    let moved = visit.browser.numbers("pneuflex.reading?.displacement ?? []")?;
    expect(moved.len() == 3 && (0.0..1.0).contains(&distance(&moved, &[0.0; 3])), || {
        format!("a click reads {moved:?}")
    })?;
    visit.click("#ticks button:last-child")?;
    visit.click("input[value=contactPressure] + span")?;
    let highest = visit.browser.numbers("pneuflex.legend")?.pop().unwrap_or(0.0);
    expect(highest > 0.0, || "there is no contact".to_owned())?;
    visit.browser.evaluate("document.getElementById('stage').scrollIntoView({block: 'center'})")?;
    visit.picture("8-blocks-contact")?;
    let complaints = visit.browser.complaints()?;
    expect(complaints.is_empty(), || format!("the page complains: {complaints:?}"))
}

/// Opens the report of the actuator that bends onto the ball of `fixtures/grip_sphere.toml` on a screen: the ball is there, in nobody's
/// way, and the plot shows the force on it.
///
/// # Errors
/// The first thing that is not as it should be.
pub fn look_at_the_ball(
    browser: &mut Browser,
    screen: &Screen,
    results: &Results,
    pictures: &Path,
) -> Result<(), String> {
    let mut visit = Visit { browser, screen, results, pictures };
    visit.open()?;
    visit.picture("9-ball")?;
    let centre = visit.browser.numbers("pneuflex.obstacles[0].centre")?;
    expect(distance(&centre, &[25.0, 0.0, -17.0]) < 1e-4, || format!("the ball is at {centre:?}"))?;
    let last = results.summary["steps"].as_array().and_then(|steps| steps.last()).ok_or("no steps")?;
    let force = last["obstacles"]["ball"]["force_n"].as_array().ok_or("no force on the ball")?;
    let force: Vec<f64> = force.iter().filter_map(Value::as_f64).collect();
    let whole = force[0].hypot(force[2]);
    let plots = visit.text_of_plots()?;
    expect(plots.contains(&format!("ball\n{whole:.3} N")), || format!("no force of {whole} N: {plots}"))?;

    // Seen from the side, there is nothing behind the ball to read; seen from below, there is the body.
    visit.click("[data-view=side]")?;
    let reads = "pneuflex.reading?.displacement ?? []";
    visit.press_on_ball()?;
    expect(visit.browser.numbers(reads)?.is_empty(), || "a click on the ball reads something".to_owned())?;
    visit.browser.evaluate(
        "for (let i = 0; i < 14; i++) \
         document.getElementById('canvas').dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowDown'}))",
    )?;
    visit.until_drawn()?;
    visit.press_on_ball()?;
    visit.picture("10-ball-from-below")?;
    expect(visit.browser.numbers(reads)?.len() == 3, || "the ball is in the way of a click".to_owned())?;
    visit.click("[data-obstacle] + span")?;
    let left = visit.browser.numbers("[pneuflex.obstacles.length]")?;
    expect(left == [0.0], || "the ball stays when it is switched off".to_owned())?;
    let complaints = visit.browser.complaints()?;
    expect(complaints.is_empty(), || format!("the page complains: {complaints:?}"))
}

/// Opens the report of a body of two materials: each can be hidden and have a range of its own.
///
/// # Errors
/// The first thing that is not as it should be.
pub fn look_at_materials(
    browser: &mut Browser,
    screen: &Screen,
    results: &Results,
    pictures: &Path,
) -> Result<(), String> {
    let mut visit = Visit { browser, screen, results, pictures };
    visit.open()?;
    let triangles = |visit: &mut Visit<'_>| visit.browser.numbers("pneuflex.surface.triangles");
    let whole = triangles(&mut visit)?;
    visit.click("[data-region='0'] + span")?;
    let layer = triangles(&mut visit)?;
    visit.show_stage()?;
    visit.picture("11-layer")?;
    // Its side towards what is hidden is seen now.
    expect(layer[0] == 0.0 && layer[1] > whole[1], || format!("of {whole:?} triangles {layer:?} are left"))?;
    visit.click("input[name=section][value=x] + span")?;
    let cut = visit.browser.numbers("pneuflex.section.triangles")?;
    expect(cut.iter().all(|count| *count > 2.0), || format!("a section of {cut:?} triangles"))?;
    visit.click("input[name=section][value=off] + span")?;
    visit.click("[data-region='0'] + span")?;
    expect(triangles(&mut visit)? == whole, || "what was hidden does not come back".to_owned())?;

    let common = visit.browser.numbers("pneuflex.colours")?;
    visit.click("#own-ranges + span")?;
    let own = visit.browser.numbers("pneuflex.colours")?;
    expect(common[..2] == common[2..] && own[1] < own[3], || format!("ranges {common:?}, on their own {own:?}"))?;
    let legend = visit.text("#legend")?;
    expect(legend.contains("everything else") && legend.contains("layer"), || format!("the legend is {legend:?}"))?;
    visit.browser.evaluate("document.getElementById('range-of').focus()")?;
    visit.browser.key("ArrowDown", 40)?;
    for (field, text) in [("#low", "0.01"), ("#high", "0.02")] {
        visit.click(field)?;
        visit.browser.write(text)?;
    }
    visit.until_drawn()?;
    let by_hand = visit.browser.numbers("pneuflex.colours")?;
    expect(by_hand[..2] == own[..2] && distance(&by_hand[2..], &[0.01, 0.02]) < 1e-12, || format!("{by_hand:?}"))?;
    visit.show_stage()?;
    visit.picture("12-own-ranges")?;
    visit.click("#own-ranges + span")?;
    let again = visit.browser.numbers("pneuflex.colours")?;
    expect(again == common, || format!("the ranges are {again:?} instead of {common:?}"))?;
    let complaints = visit.browser.complaints()?;
    expect(complaints.is_empty(), || format!("the page complains: {complaints:?}"))
}

/// Opens the report of a quarter of a cylinder under a plate: it is shown whole, with both plates.
///
/// # Errors
/// The first thing that is not as it should be.
pub fn look_at_a_quarter(
    browser: &mut Browser,
    screen: &Screen,
    results: &Results,
    pictures: &Path,
) -> Result<(), String> {
    let mut visit = Visit { browser, screen, results, pictures };
    visit.open()?;
    let images = visit.browser.numbers("[pneuflex.surface.images]")?;
    expect(images == [4.0], || format!("{images:?} images"))?;
    visit.picture("13-quarter")?;
    // The last displacement along x has both signs on the whole.
    visit.browser.evaluate("document.getElementById('more-fields').focus()")?;
    visit.browser.key("ArrowDown", 40)?;
    visit.until_drawn()?;
    let colours = visit.browser.numbers("pneuflex.colours")?;
    expect((colours[0] + colours[1]).abs() < 1e-9 && colours[1] > 1.0, || format!("colours {colours:?}"))?;
    visit.click("#whole + span")?;
    let images = visit.browser.numbers("[pneuflex.surface.images]")?;
    expect(images == [1.0], || format!("{images:?} images of the part alone"))?;
    let complaints = visit.browser.complaints()?;
    expect(complaints.is_empty(), || format!("the page complains: {complaints:?}"))
}

/// Where there are no three-dimensional graphics, the page says so and shows the rest.
///
/// # Errors
/// It does not.
pub fn without_graphics(browser: &mut Browser, results: &Results) -> Result<(), String> {
    open(browser, results)?;
    let state = browser.evaluate(
        "[document.getElementById('no-view').checkVisibility(), document.getElementById('canvas').checkVisibility(), \
         document.querySelectorAll('.plots svg').length, document.querySelectorAll('.results tbody tr').length]",
    )?;
    let steps = results.summary["steps"].as_array().map_or(0, Vec::len);
    expect(state == json!([true, false, 6, steps]), || format!("notice, canvas, plots and rows are {state}"))?;
    let complaints = browser.complaints()?;
    expect(complaints.is_empty(), || format!("the page complains: {complaints:?}"))
}
