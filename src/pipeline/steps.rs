//! What each stage does with a job: fetches its input from the pair, calls the stage, says a word about the result.

use super::images::geometry_images;
use super::job::{LayoutMethod, MapJob, MapOptions, Outputs, PageOptions, Relaxation};
use super::lay_out::lay_out;
use super::line::Step;
use super::pair::{Pair, Whole};
use super::templates::Templates;
use super::textures::{check_texture, further_files};
use crate::error::{Error, Result};
use crate::gpu::{Compute, Device};
use crate::map::divided::Divided;
use crate::map::embedding::Embedding;
use crate::map::product::{GeometryImages, NamedFile, Product, Shown, Side};
use crate::map::refined::{RefinedMesh, refined_mesh};
use crate::map::report::{LayoutSummary, RelaxationSummary, Report};
use crate::stage;
use crate::stage::check::{Checked, LoadedMesh};
use crate::stage::cluster::BaseVertices;
use crate::stage::compose::{CertifiedMap, Composed, images_there, in_file_terms};
use crate::stage::layout::Layout;
use crate::stage::load::{LoadOptions, Loaded};
use crate::stage::polish::{DREAD, polish_samples};
use crate::stage::refine::RefineOptions;
use crate::stage::relax::{RelaxOptions, energy, promise, relax_arcs, relax_lifted, relax_patches};
use crate::stage::simplify::{ENOUGH, Simple, simplify as simplify_pair};

/// Layouts whose promises differ by less are equally good, and the one with the shorter arcs is taken.
const SAME_PROMISE: f64 = 1e-3;

/// Both meshes embedded, with the layout in numbers and what the user should know.
pub struct Embedded {
    summary: LayoutSummary,
    embedding: Embedding,
    relaxation: RelaxationSummary,
    notes: Vec<String>,
}

/// A finished map before it is written.
pub struct Finished {
    summary: LayoutSummary,
    relaxation: RelaxationSummary,
    composed: Composed,
    notes: Vec<String>,
    refined: Option<[RefinedMesh; 2]>,
}

/// A finished map with its images, in terms of the files.
pub struct Baked {
    summary: LayoutSummary,
    relaxation: RelaxationSummary,
    map: CertifiedMap,
    notes: Vec<String>,
    files: Vec<NamedFile>,
    images: Option<GeometryImages>,
    refined: Option<[RefinedMesh; 2]>,
    divided: [Divided; 2],
    figures: Vec<NamedFile>,
}

/// A certified map with what it was made from.
#[derive(Debug)]
pub struct Mapped {
    /// The meshes, landmarks and warnings about them.
    pub checked: Checked,
    /// Both maps with their base complex, arcs and certificate.
    pub map: CertifiedMap,
    /// The layout in numbers.
    pub layout: LayoutSummary,
    /// What the relaxation did.
    pub relaxation: RelaxationSummary,
}

pub fn load((job, seal): (MapJob, Option<NamedFile>), templates: &Templates, step: &Step) -> Result<(Outputs, Loaded)> {
    let MapJob { source, target, landmarks, target_landmarks, hint, texture, out } = job;
    let known = templates.read(&source);
    let loaded = stage::load::load_with(LoadOptions { source, target, landmarks, target_landmarks, hint }, known)?;
    texture.as_deref().map_or(Ok(()), |texture| check_texture(texture, &loaded.source))?;
    let vertices = [&loaded.source, &loaded.target].map(|file| file.positions.len());
    let landmarks = loaded.landmarks.as_ref().map_or(0, |l| l.names.len());
    step.detail(format!("{} and {} vertices, {landmarks} landmarks", vertices[0], vertices[1]));
    Ok((Outputs { dir: out, texture, seal }, loaded))
}

pub fn check((outputs, loaded): (Outputs, Loaded), templates: &Templates) -> Result<Pair<()>> {
    let known = templates.inspect(&loaded.source);
    let checked = stage::check::check_with(loaded, known)?;
    Ok(Pair { outputs, checked, whole: None, made: () })
}

/// Puts simple meshes in the place of large ones, whose map is to be relaxed all over.
pub fn simplify(mut pair: Pair<()>, how: Relaxation, step: &Step) -> Result<Pair<()>> {
    if how == Relaxation::Full
        && let Some(Simple { checked, simplified }) = simplify_pair(&pair.checked, ENOUGH)
    {
        let vertices = simplified.each_ref().map(|s| s.mesh.positions.len());
        step.detail(format!("to {} and {} vertices", vertices[0], vertices[1]));
        let checked = std::mem::replace(&mut pair.checked, checked);
        pair.whole = Some(Box::new(Whole { checked, simplified }));
    }
    Ok(pair)
}

pub fn cluster(pair: Pair<()>, step: &Step) -> Result<Pair<Vec<BaseVertices>>> {
    pair.then(|checked, ()| {
        let [on_source, on_target] = checked.sites();
        let sets = stage::cluster::cluster(checked.meshes(), [&on_source, &on_target], &checked.guides);
        let (lasting, all) = sets.last().map_or((0, 0), |set| (set.lasting, set.vertices[0].len()));
        let limbs = lasting - checked.landmarks.source.len();
        step.detail(format!("{limbs} limbs without a landmark matched, {} more places", all - lasting));
        Ok(sets)
    })
}

pub fn trace(
    pair: Pair<Vec<BaseVertices>>,
    compute: &Compute,
    method: LayoutMethod,
    step: &Step,
) -> Result<Pair<Vec<Layout>>> {
    pair.then(|checked, sets| {
        let layouts = lay_out(compute, checked, &sets, method)?;
        if let Some(Layout { base, .. }) = layouts.first() {
            step.detail(format!("{} arcs, {} patches", base.arcs.len(), base.patches.len()));
        }
        Ok(layouts)
    })
}

pub fn embed(pair: Pair<Vec<Layout>>, method: LayoutMethod, _: &Step) -> Result<Pair<Vec<Embedded>>> {
    pair.then(|checked, layouts| {
        let embed = |layout: Layout| {
            let summary = LayoutSummary {
                kind: method.name(),
                arcs: layout.base.arcs.len(),
                patches: layout.base.patches.len(),
                postponed: layout.postponed,
                flips: 0,
            };
            let (embedding, notes) = stage::embed::embed(checked.meshes(), layout)?;
            let relaxation = RelaxationSummary {
                method: "none",
                stretch: Default::default(),
                energies: Vec::new(),
                polish: Vec::new(),
            };
            Ok(Embedded { summary, embedding, relaxation, notes })
        };
        layouts.into_iter().map(embed).collect()
    })
}

pub fn stretch(pair: Pair<Vec<Embedded>>, compute: &Compute, step: &Step) -> Result<Pair<Vec<Embedded>>> {
    pair.then(|_, mut candidates| {
        for embedded in &mut candidates {
            let stretch = stage::stretch::stretch(compute, &mut embedded.embedding)?;
            step.detail(stretch.map(|s| format!("E_L2 {:.3} to {:.3}", s.before, s.after)).join(", "));
            embedded.relaxation.stretch = stretch;
        }
        Ok(candidates)
    })
}

pub fn relax(
    pair: Pair<Vec<Embedded>>,
    compute: &Compute,
    how: Relaxation,
    tolerance: f64,
    step: &Step,
) -> Result<Pair<Embedded>> {
    // What polishing does to simple meshes is lost on the way back.
    let is_final = pair.whole.is_none();
    pair.then(|checked, mut candidates| {
        let meshes = checked.meshes();
        let promises: Vec<f64> = match candidates.len() {
            1 => vec![0.0],
            _ => candidates.iter().map(|e| promise(compute, meshes, &e.embedding)).collect::<Result<_>>()?,
        };
        let least = promises.iter().copied().fold(f64::INFINITY, f64::min);
        let best = promises.iter().position(|&p| p <= least + SAME_PROMISE);
        let mut embedded = candidates.swap_remove(best.ok_or_else(|| Error::bug("no layout was made"))?);
        embedded.relaxation.method = how.name();
        let options = RelaxOptions { tolerance, ..RelaxOptions::default() };
        embedded.relaxation.energies = match how {
            Relaxation::None => vec![energy(meshes, &embedded.embedding)],
            Relaxation::Patch => relax_patches(meshes, &mut embedded.embedding, &options),
            Relaxation::Full => {
                let relaxing = relax_arcs(compute, meshes, &mut embedded.embedding, &options)?;
                embedded.summary.flips = relaxing.flips;
                if relaxing.flips > 0 {
                    step.detail(format!("{} arcs flipped", relaxing.flips));
                }
                relaxing.energies
            }
        };
        if how == Relaxation::Full && is_final {
            let polish = polish_samples(meshes, &mut embedded.embedding, tolerance, &DREAD)?;
            if let [first, .., last] = polish.energies.as_slice() {
                let turned_back = polish.turned_back;
                step.detail(format!("polish {first:.3} to {last:.3}, {turned_back} sampled triangles turned back"));
            }
            embedded.relaxation.polish = polish.energies;
        }
        if let [first, .., last] = embedded.relaxation.energies.as_slice() {
            step.detail(format!("energy {first:.3} to {last:.3} in {} rounds", embedded.relaxation.energies.len() - 1));
        }
        Ok(embedded)
    })
}

/// Carries the map of simple meshes back to the given ones and relaxes it there a little more; where it cannot be carried
/// back, the map of the given meshes is made without.
pub fn lift(
    mut pair: Pair<Embedded>,
    compute: &Compute,
    layout: LayoutMethod,
    tolerance: f64,
    step: &Step,
) -> Result<Pair<Embedded>> {
    let Some(whole) = pair.whole.take() else { return Ok(pair) };
    let Whole { checked, simplified } = *whole;
    let meshes = checked.meshes();
    let Ok(embedding) = stage::lift::lift(meshes, &simplified, &pair.made.embedding) else {
        step.detail("mapped without simple meshes");
        let pair = Pair { outputs: pair.outputs, checked, whole: None, made: () };
        let traced = trace(cluster(pair, step)?, compute, layout, step)?;
        let embedded = stretch(embed(traced, layout, step)?, compute, step)?;
        return relax(embedded, compute, Relaxation::Full, tolerance, step);
    };
    let mut made = Embedded { embedding, ..pair.made };
    let simple = made.relaxation.energies.last().copied().unwrap_or(f64::INFINITY);
    let lifted = relax_lifted(compute, meshes, &mut made.embedding, tolerance, simple)?;
    made.relaxation.energies.extend(lifted.energies);
    made.relaxation.polish = lifted.polish;
    Ok(Pair { outputs: pair.outputs, checked, whole: None, made })
}

pub fn compose(pair: Pair<Embedded>, step: &Step) -> Result<Pair<Finished>> {
    pair.then(|checked, Embedded { summary, embedding, relaxation, notes }| {
        let composed = stage::compose::compose(checked.meshes(), embedding)?;
        if !composed.certificate.bijective {
            return Err(Error::bug(format!("the finished map is not bijective: {:?}", composed.certificate)));
        }
        step.detail("certified");
        Ok(Finished { summary, relaxation, composed, notes, refined: None })
    })
}

/// Inserts vertices into both meshes where the compatible meshes miss the other surface.
pub fn refine(pair: Pair<Finished>, options: Option<&RefineOptions>, step: &Step) -> Result<Pair<Finished>> {
    let Some(options) = options else { return Ok(pair) };
    pair.then(|checked, finished| {
        let sides = [&checked.source, &checked.target];
        let one = |k: usize| -> Result<(RefinedMesh, [usize; 2])> {
            let LoadedMesh { file, mesh, omitted, canonical, .. } = sides[k];
            let refinement = stage::refine::refine(checked.meshes(), &finished.composed, k, options);
            let images = images_there(&refinement.images, [canonical, &sides[1 - k].canonical]);
            let subdivision = refinement.subdivision.there(canonical, mesh);
            Ok((refined_mesh(file, mesh, omitted, &subdivision, images)?, refinement.inserted))
        };
        let (source, target) = rayon::join(|| one(0), || one(1));
        let ((source, on_source), (target, on_target)) = (source?, target?);
        let told = [on_source, on_target].map(|[features, profile]| format!("{features} and {profile}"));
        step.detail(format!("vertices for features and profile: {} (source), {} (target)", told[0], told[1]));
        Ok(Finished { refined: Some([source, target]), ..finished })
    })
}

pub fn mapped(pair: Pair<Finished>) -> Mapped {
    let Pair { mut checked, made: Finished { summary, relaxation, composed, notes, .. }, .. } = pair;
    let map = in_file_terms(&checked, composed);
    checked.warnings.extend(notes);
    Mapped { checked, map, layout: summary, relaxation }
}

/// The last stage in canonical order: afterwards the map speaks of the files' vertices and faces.
pub fn bake(pair: Pair<Finished>, compute: &Compute, options: &MapOptions, step: &Step) -> Result<Pair<Baked>> {
    let Outputs { texture, seal, .. } = pair.outputs.clone();
    pair.then(|checked, Finished { summary, relaxation, composed, mut notes, refined }| {
        let (images, figures) = geometry_images(compute, checked, &composed, options.image, options.layered)?;
        step.detail(format!("{} images", images.as_ref().map_or(0, |i| i.files.len())));
        let (mut files, more) = further_files(compute, checked, &composed, images.as_ref(), texture.as_deref())?;
        notes.extend(more);
        files.extend(seal);
        let meshes = &composed.embedding.meshes;
        let divided = [(0, &checked.source), (1, &checked.target)].map(|(k, m)| Divided::new(&meshes[k], &m.canonical));
        let map = in_file_terms(checked, composed);
        Ok(Baked { summary, relaxation, map, notes, files, images, refined, divided, figures })
    })
}

pub fn write(pair: Pair<Baked>, device: &str, page: Option<&PageOptions>, step: &Step) -> Result<Report> {
    let Pair { outputs, checked, made, .. } = &pair;
    let shown = page.map(|page| Shown {
        divided: [&made.divided[0], &made.divided[1]],
        figures: &made.figures,
        texture: outputs.texture.as_deref(),
        command: &page.command,
    });
    let product = Product {
        source: side(&checked.source, made, 0),
        target: side(&checked.target, made, 1),
        landmarks: &checked.landmarks,
        base: &made.map.base,
        layout: made.summary.clone(),
        relaxation: made.relaxation.clone(),
        certificate: made.map.certificate,
        files: &made.files,
        images: made.images.as_ref(),
        device,
        warnings: checked.warnings.iter().chain(&made.notes).cloned().collect(),
        shown,
    };
    stage::write::write(&product, &outputs.dir, || step.seconds())
}

fn side<'a>(LoadedMesh { file, mesh, omitted, .. }: &'a LoadedMesh, made: &'a Baked, k: usize) -> Side<'a> {
    let refined = made.refined.as_ref().map(|sides| &sides[k]);
    Side { file, mesh, omitted, arcs: &made.map.arcs[k], image: &made.map.maps[k].images, refined }
}

/// The device in the report; without the number of threads, on which no result depends.
pub fn device_line(device: &Device) -> String {
    let name = match device.compute {
        Compute::Cpu => "CPU",
        Compute::Gpu(_) => &device.description,
    };
    device.note.as_ref().map_or(name.to_owned(), |note| format!("{name}; {note}"))
}
