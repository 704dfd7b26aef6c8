//! A run that can begin: every value of the command line checked, every file that must be there looked for.

use crate::backend::Backend;
use crate::cli::{AOV_SPACES, DIFFUSIONS, RenderArgs};
use crate::scene_source::SceneSource;
use crate::techniques::paper::Paper;
use crate::techniques::{fulfilled, idle, wishes};
use cutis_render::film::{Bloom, Checkpoint, Film, Format, check_output, layer_path};
use cutis_render::settings::{Quality, TechniqueSettings};
use cutis_render::{Aov, Settings, TechniqueName};
use cutis_scene::head::HeadDetail;
use cutis_scene::{AtlasChoice, ReadOptions};
use miette::{Result, miette};
use std::fmt::Display;
use std::path::{Path, PathBuf};

/// Everything `cutis render` needs to know.
#[derive(Debug, Clone)]
pub struct Job {
    /// Where it is computed.
    pub backend: Backend,
    /// What is rendered.
    pub source: SceneSource,
    /// How it is rendered.
    pub settings: Settings,
    /// How it is developed; the exposure is added to that of the scene's camera.
    pub film: Film,
    /// Where it goes.
    pub output: PathBuf,
    /// In which format.
    pub format: Format,
    /// Threads to work with; none: one per processor.
    pub threads: Option<usize>,
    /// Whose numbers are the defaults.
    pub paper: Option<Paper>,
    /// Whether the result is told as JSON.
    pub json: bool,
    /// Wishes that have no effect, in words.
    pub warnings: Vec<String>,
}

impl Job {
    /// Checks the arguments.
    pub fn new(args: &RenderArgs) -> Result<Self> {
        let backend = named("--backend", &args.backend, Backend::ALL.map(|b| (b.to_string(), b)))?;
        let paper =
            args.as_in.as_deref().map(|name| named("--as-in", name, Paper::ALL.map(|p| (p.to_string(), p))));
        let paper = paper.transpose()?;
        let mut warnings = Vec::new();
        let settings = settings(args, paper, &mut warnings)?;
        backend.check(settings.technique)?;
        let film = film(args)?;
        let threads = threads_in_range(args.threads)?;
        let source = source(args, paper)?;
        let format = check_outputs(args, &settings)?;
        warnings.extend(idle_wishes(args, format));
        let (output, json) = (args.output.clone(), args.json);
        Ok(Self { backend, source, settings, film, output, format, threads, paper, json, warnings })
    }
}

fn settings(args: &RenderArgs, paper: Option<Paper>, warnings: &mut Vec<String>) -> Result<Settings> {
    let quality = named("--quality", &args.quality, Quality::ALL.map(|q| (q.to_string(), q)))?;
    let mut preset = Settings::default().with_quality(quality);
    if let Some([width, height]) = paper.and_then(Paper::stage).map(|stage| stage.size) {
        (preset.width, preset.height) = (width, height);
    }
    let technique = technique(args, paper)?;
    let usual = TechniqueSettings::default();
    let of_paper = paper.map_or(usual.clone(), |paper| paper.settings(usual));
    if let Some(paper) = paper.filter(|p| p.stage().is_none() && !p.techniques().contains(&technique)) {
        warnings.push(format!("--as-in {paper} has no effect: the technique is {technique}"));
    }
    let wishes = wishes(&args.techniques, warnings)?;
    warnings.extend(idle(&wishes, technique));
    let (width, height) = args.size.as_deref().map_or(Ok((preset.width, preset.height)), size)?;
    let mut aovs: Vec<Aov> = Vec::new();
    for name in &args.aov {
        let aov = name.parse().map_err(|reason| miette!("--aov: {reason}"))?;
        if !aovs.contains(&aov) {
            aovs.push(aov);
        }
    }
    let settings = Settings {
        technique,
        techniques: fulfilled(of_paper, wishes)?,
        diffusion: named("--diffusion", &args.diffusion, DIFFUSIONS.map(|d| (d.to_string(), d)))?,
        width,
        height,
        samples_per_pixel: args.samples.unwrap_or(preset.samples_per_pixel),
        irradiance_size: args.irradiance_size.unwrap_or(preset.irradiance_size),
        gaussians: args.gaussians,
        muted_gaussians: Vec::new(),
        shadow_samples: args.shadow_samples.unwrap_or(preset.shadow_samples),
        diffusion_report: args.diffusion_report,
        ambient_samples: args.ambient_samples.unwrap_or(preset.ambient_samples),
        seed: args.seed,
        target_error: args.target_error,
        close_holes: args.close_holes,
        checkpoint: args.resume.then(|| checkpoint_beside(&args.output)),
        aovs,
        aov_space: named("--aov-space", &args.aov_space, AOV_SPACES.map(|(n, s)| (n.to_owned(), s)))?,
    };
    settings.check().map_err(refused)?;
    Ok(settings)
}

/// The technique that was named, else that of the paper, else the usual one.
fn technique(args: &RenderArgs, paper: Option<Paper>) -> Result<TechniqueName> {
    if let Some(name) = &args.technique {
        return name.parse().map_err(|reason| miette!("--technique: {reason}"));
    }
    match paper.map(|paper| (paper, paper.techniques())) {
        None => Ok(Settings::default().technique),
        Some((_, [technique])) => Ok(*technique),
        Some((paper, several)) => {
            let names = several.iter().map(TechniqueName::to_string).collect::<Vec<_>>().join(", ");
            Err(miette!("--as-in {paper} knows several techniques: say --technique {names}"))
        }
    }
}

/// Where the state of a long rendering is kept.
fn checkpoint_beside(output: &Path) -> Checkpoint {
    let mut name = output.as_os_str().to_owned();
    name.push(".paths");
    Checkpoint { path: name.into() }
}

fn film(args: &RenderArgs) -> Result<Film> {
    let mut film = Film::default();
    if let Some(exposure_ev) = args.exposure_ev {
        film.exposure_ev = exposure_ev;
    }
    if let Some(name) = &args.tone_mapper {
        film.tone_mapper = name.parse().map_err(|reason: String| miette!("--tone-mapper: {reason}"))?;
    }
    if let Some(strength) = args.bloom {
        // Not a number is not 0: it stays, for the film to refuse.
        film.bloom = if strength == 0.0 { None } else { Some(Bloom { strength, ..Bloom::default() }) };
    }
    film.check().map_err(refused)?;
    Ok(film)
}

fn source(args: &RenderArgs, paper: Option<Paper>) -> Result<SceneSource> {
    let millimetres = args.millimetres_per_unit;
    for (flag, length_mm) in [("--millimetres-per-unit", millimetres), ("--longest-side", args.longest_side)]
    {
        if let Some(mm) = length_mm.filter(|mm| !(*mm > 0.0 && mm.is_finite())) {
            return Err(miette!("{flag} must be above 0 mm, got {mm}"));
        }
    }
    let time_s = args.time.unwrap_or(0.0);
    if !(0.0..=1e5).contains(&time_s) {
        return Err(miette!("--time must be 0 to 100000 s, got {time_s}"));
    }
    let stage = paper.and_then(Paper::stage);
    // Who says how long a unit is knows how large the head is.
    let of_paper = stage.filter(|_| millimetres.is_none()).map(|stage| stage.longest_side_mm);
    let detail = head_detail(args)?;
    let maps = [&args.albedo, &args.normal, &args.specular, &args.environment];
    maps.into_iter().chain([&args.scene]).flatten().try_for_each(|path| must_exist(path))?;
    let options = ReadOptions {
        millimetres_per_unit: millimetres,
        atlas: atlas(args.atlas.as_deref(), args.scene.is_some())?,
        albedo: args.albedo.clone(),
        normal: args.normal.clone(),
        specular: args.specular.clone(),
        ..ReadOptions::default()
    };
    Ok(SceneSource {
        file: args.scene.clone(),
        options,
        environment: args.environment.clone(),
        detail,
        material: args.material.clone().or_else(|| stage.map(|stage| stage.material.to_owned())),
        longest_side_mm: args.longest_side.or(of_paper),
        time_s,
    })
}

/// Where light is to lie, by the word of `--atlas`.
pub fn atlas(word: Option<&str>, has_file: bool) -> Result<Option<AtlasChoice>> {
    let choice = AtlasChoice::ALL.into_iter().find(|choice| Some(choice.name()) == word);
    if !has_file && choice == Some(AtlasChoice::New) {
        return Err(miette!("--atlas new is for mesh files; the built-in head has an atlas of its own"));
    }
    Ok(choice)
}

fn head_detail(args: &RenderArgs) -> Result<HeadDetail> {
    if args.scene.is_some() && (args.triangles.is_some() || args.map_size.is_some()) {
        return Err(miette!(
            "--triangles and --map-size are for the built-in head; a scene file has what it has"
        ));
    }
    let HeadDetail { triangles, map_size } = HeadDetail::default();
    let triangles = args.triangles.unwrap_or(triangles);
    let triangles = in_range("--triangles", triangles, 1000..=4_000_000, "1000 to 4000000")?;
    let map_size = args.map_size.unwrap_or(map_size);
    in_range("--map-size", map_size as usize, 0..=8192, "0 to 8192 texels")?;
    Ok(HeadDetail { triangles, map_size })
}

/// Finds a missing file before the work; the reader says everything else that may be wrong with it.
pub fn must_exist(path: &Path) -> Result<()> {
    if path.exists() || path.to_string_lossy().starts_with("assets:") {
        return Ok(());
    }
    Err(miette!("{}: there is no such file", path.display()))
}

/// Finds out before the work whether picture and layers can be written.
fn check_outputs(args: &RenderArgs, settings: &Settings) -> Result<Format> {
    let format = check_output(&args.output, args.bits).map_err(refused)?;
    if !format.is_scene_referred() {
        for aov in &settings.aovs {
            check_output(&layer_path(&args.output, &aov.to_string()), args.bits).map_err(refused)?;
        }
    }
    Ok(format)
}

/// Wishes for the film, where the file takes none.
fn idle_wishes(args: &RenderArgs, format: Format) -> Vec<String> {
    let wishes = [
        ("--exposure-ev", args.exposure_ev.is_some()),
        ("--tone-mapper", args.tone_mapper.is_some()),
        ("--bloom", args.bloom.is_some()),
    ];
    let idle = wishes.into_iter().filter(|(_, given)| *given && format.is_scene_referred());
    idle.map(|(flag, _)| format!("{flag} has no effect: EXR files hold the radiance as rendered")).collect()
}

/// Reads `--size`.
pub fn size(text: &str) -> Result<(u32, u32)> {
    let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    sides.ok_or_else(|| miette!("--size must be WIDTHxHEIGHT in pixels, such as 1024x1024, got '{text}'"))
}

/// The value of a name.
pub fn named<T: Copy>(flag: &str, name: &str, known: impl IntoIterator<Item = (String, T)>) -> Result<T> {
    let value = known.into_iter().find_map(|(known, value)| (known == name).then_some(value));
    value.ok_or_else(|| miette!("{flag}: there is no '{name}'"))
}

/// Checks `--threads`.
pub fn threads_in_range(threads: Option<usize>) -> Result<Option<usize>> {
    threads.map(|n| in_range("--threads", n, 1..=1024, "1 to 1024")).transpose()
}

/// A number, if it is allowed.
pub fn in_range(
    flag: &str,
    value: usize,
    allowed: std::ops::RangeInclusive<usize>,
    range: &str,
) -> Result<usize> {
    if allowed.contains(&value) { Ok(value) } else { Err(miette!("{flag} must be {range}, got {value}")) }
}

/// A library's error is already one line that says what is wrong.
pub fn refused(error: impl Display) -> miette::Report {
    miette!("{error}")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings_of(words: &[&str]) -> Settings {
        job_of(words).settings
    }

    #[test]
    fn flags_win_over_the_quality() {
        assert_eq!(settings_of(&[]), Settings::default());
        let low = Settings::default().with_quality(Quality::Low);
        assert_eq!(settings_of(&["--quality", "low"]), low);
        let own = settings_of(&["--quality", "low", "--samples", "9", "--size", "64x32"]);
        assert_eq!(own, Settings { samples_per_pixel: 9, width: 64, height: 32, ..low });
    }

    fn try_job_of(words: &[&str]) -> Result<Job> {
        use clap::Parser;
        let cli = crate::cli::Cli::try_parse_from(["cutis", "render"].iter().chain(words)).expect("is sound");
        let crate::cli::Command::Render(args) = cli.command else { panic!("is a rendering") };
        Job::new(&args)
    }

    fn job_of(words: &[&str]) -> Job {
        try_job_of(words).expect("is in range")
    }

    #[test]
    fn a_paper_wins_over_the_quality_and_flags_win_over_the_paper() {
        let paper = job_of(&["--as-in", "mertens-2003", "--quality", "full"]);
        let Settings { technique, techniques, width, height, .. } = &paper.settings;
        assert_eq!((*technique, *width, *height), (TechniqueName::ImageSpace, 500, 500));
        assert!(!techniques.image_space.jacobian && !techniques.image_space.light_views);
        assert!(techniques.image_space.uniform_samples > 0, "both kinds of samples are combined");
        assert_eq!(paper.source.material.as_deref(), Some("skin1"));
        assert_eq!(paper.source.longest_side_mm, Some(100.0));
        assert!(paper.warnings.is_empty(), "{:?}", paper.warnings);
        let own = ["--jacobian", "on", "--size", "64x48", "--material", "marble", "--longest-side", "50"];
        let flags = job_of(&[&["--as-in", "mertens-2003"][..], &own].concat());
        assert!(flags.settings.techniques.image_space.jacobian);
        assert!(!flags.settings.techniques.image_space.light_views, "the rest is the paper's");
        assert_eq!((flags.settings.width, flags.settings.height), (64, 48));
        assert_eq!(flags.source.material.as_deref(), Some("marble"));
        assert_eq!(flags.source.longest_side_mm, Some(50.0));
        let unit = job_of(&["--as-in", "mertens-2003", "--millimetres-per-unit", "10"]);
        assert_eq!(unit.source.longest_side_mm, None, "who knows the unit knows the size");
        let other = job_of(&["--as-in", "mertens-2003", "--technique", "wrap"]);
        assert_eq!((other.settings.technique, other.settings.width), (TechniqueName::Wrap, 500));
    }

    #[test]
    fn a_paper_of_several_techniques_takes_the_one_that_is_named() {
        let said = try_job_of(&["--as-in", "green-2004"]).map(|_| ()).expect_err("of three").to_string();
        assert!(said.contains("--technique wrap, depth-absorption, texture-blur"), "{said}");
        let green = |technique| job_of(&["--as-in", "green-2004", "--technique", technique]);
        let techniques = green("wrap").settings.techniques;
        assert_eq!(techniques, green("texture-blur").settings.techniques);
        assert_eq!(techniques, Paper::Green2004.settings(TechniqueSettings::default()));
        assert_eq!(green("wrap").source.longest_side_mm, None);
        let idle = green("texture-space").warnings;
        assert_eq!(idle, ["--as-in green-2004 has no effect: the technique is texture-space"]);
        let own =
            job_of(&["--as-in", "green-2004", "--technique", "texture-blur", "--blur-weights", "normalised"]);
        let normalised = cutis_render::technique::texture_blur::BlurWeights::Normalised;
        assert_eq!(own.settings.techniques.texture_blur.weights, normalised);
    }

    #[test]
    fn sizes_are_read() {
        assert_eq!(size("640x480").expect("a size"), (640, 480));
        for bad in ["640", "x", "640x", "-1x5", "640x480x3", "6.4x4", "99999999999x1", ""] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }
}
