//! The outputs of a run: the picture and its layers, written together or not at all.

use super::layer_png::{self, Scale};
use super::partial_file::PartialFile;
use super::png::{self, Depth};
use super::{Film, FilmError, Format, develop, exr};
use crate::{Frame, Layer, PassTime};
use std::fs;
use std::path::{Path, PathBuf};

/// What was written.
#[derive(Debug, Clone, Default)]
pub struct Written {
    /// The picture.
    pub picture: PathBuf,
    /// Layers, in the order of the frame.
    pub layers: Vec<LayerFile>,
    /// What the film did and how long it took; empty for scene-referred formats.
    pub passes: Vec<PassTime>,
    /// Pixels that held no finite number: a fault of the renderer. PNG files show them black or white.
    pub broken_pixels: usize,
}

/// Where one layer went.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerFile {
    /// Name of the layer.
    pub name: String,
    /// The file that holds it.
    pub path: PathBuf,
    /// Values shown as black and as white; none where the file holds the values themselves.
    pub black_and_white: Option<[f32; 2]>,
}

/// Looks, before the long work, whether the output can be written at the end, and in which format.
///
/// # Errors
/// If the extension or the depth is not known, the folder missing, something else in the file's place, or the
/// system refuses to create a file there.
pub fn check_output(path: &Path, bits: Option<u32>) -> Result<Format, FilmError> {
    let format = Format::of(path, bits)?;
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(FilmError::MissingFolder { path: path.to_owned(), folder: folder.to_owned() });
    }
    if fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(FilmError::NotAFile { path: path.to_owned() });
    }
    // Created and dropped: the system's own answer, for rights, full disks and read-only ones.
    PartialFile::create(path)?;
    Ok(format)
}

/// File of a layer beside a picture that cannot hold it: `head.png` and `normal` make `head.normal.png`.
pub fn layer_path(picture: &Path, layer: &str) -> PathBuf {
    picture.with_extension(format!("{layer}.png"))
}

/// Writes a frame. PNG files get the developed picture and each layer in a file beside it ([`layer_path`]), EXR
/// files the frame as it is, untouched by the film, and the layers as named channels. Old files of the same names are
/// replaced when all the new ones are complete.
///
/// # Errors
/// If a file cannot be encoded or written; then the old ones are still there.
pub fn write(path: &Path, format: Format, frame: &Frame, film: &Film) -> Result<Written, FilmError> {
    film.check()?;
    match format {
        Format::Png8 => write_png(path, Depth::Eight, frame, film),
        Format::Png16 => write_png(path, Depth::Sixteen, frame, film),
        Format::ExrHalf => write_exr(path, true, frame),
        Format::ExrFloat => write_exr(path, false, frame),
    }
}

/// The bytes of a half-float EXR file as [`write()`] makes it, with words about the picture in its header (attribute
/// `comments`).
///
/// # Errors
/// If the frame cannot be encoded; the text says why.
pub fn annotated_exr(frame: &Frame, comment: &str) -> Result<Vec<u8>, String> {
    let mut file = std::io::Cursor::new(Vec::new());
    exr::write_frame(&mut file, frame, true, Some(comment)).map_err(|e| e.to_string())?;
    Ok(file.into_inner())
}

fn write_exr(path: &Path, half: bool, frame: &Frame) -> Result<Written, FilmError> {
    PartialFile::fill(path, |writer| exr::write_frame(writer, frame, half, None))?.commit()?;
    let inside =
        |layer: &Layer| LayerFile { name: layer.name.clone(), path: path.to_owned(), black_and_white: None };
    let layers = frame.layers.iter().map(inside).collect();
    Ok(Written { picture: path.to_owned(), layers, passes: Vec::new(), broken_pixels: broken_pixels(frame) })
}

fn write_png(path: &Path, depth: Depth, frame: &Frame, film: &Film) -> Result<Written, FilmError> {
    let picture = develop(frame, film);
    let mut partials = vec![PartialFile::fill(path, |writer| png::write_picture(writer, &picture, depth))?];
    let mut layers = Vec::new();
    for layer in &frame.layers {
        let (partial, file) = fill_layer(path, depth, layer)?;
        partials.push(partial);
        layers.push(file);
    }
    partials.into_iter().try_for_each(PartialFile::commit)?;
    let (passes, broken_pixels) = (picture.passes, broken_pixels(frame));
    Ok(Written { picture: path.to_owned(), layers, passes, broken_pixels })
}

fn fill_layer(picture: &Path, depth: Depth, layer: &Layer) -> Result<(PartialFile, LayerFile), FilmError> {
    let path = layer_path(picture, &layer.name);
    let scale = Scale::of(layer);
    let raster = layer_png::raster(layer, scale);
    let partial = PartialFile::fill(&path, |writer| png::write_raster(writer, &raster, depth))?;
    let black_and_white = Some([scale.low, scale.high]);
    Ok((partial, LayerFile { name: layer.name.clone(), path, black_and_white }))
}

fn broken_pixels(frame: &Frame) -> usize {
    frame.pixels.iter().filter(|pixel| !pixel.is_finite()).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec4;

    fn frame() -> Frame {
        let layer = Layer {
            name: "normal".to_owned(),
            width: 2,
            height: 2,
            channels: ["X", "Y", "Z"].map(str::to_owned).to_vec(),
            pixels: vec![Vec4::Z; 4],
        };
        Frame { width: 3, height: 2, pixels: vec![Vec4::ONE; 6], layers: vec![layer], ..Frame::default() }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_png_has_its_layers_beside_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("head.png");
        let written = write(&path, Format::Png8, &frame(), &Film::default()).expect("written");
        assert_eq!(names(folder.path()), ["head.normal.png", "head.png"]);
        assert_eq!(written.layers[0].path, folder.path().join("head.normal.png"));
        assert_eq!(written.layers[0].black_and_white, Some([-1.0, 1.0]));
        let normal = image::open(&written.layers[0].path).expect("a PNG").to_rgb8();
        assert_eq!(normal.get_pixel(0, 0).0, [128, 128, 255]);
        let passes: Vec<_> = written.passes.iter().map(|p| p.name.as_str()).collect();
        assert_eq!(passes, ["bloom", "tone map"]);
    }

    #[test]
    fn an_exr_holds_everything_untouched_by_the_film() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("head.exr");
        let film = Film { exposure_ev: 3.0, ..Film::default() };
        let written = write(&path, Format::ExrFloat, &frame(), &film).expect("written");
        assert_eq!(names(folder.path()), ["head.exr"]);
        assert_eq!(written.layers[0].path, path);
        let read = image::open(&path).expect("an EXR").to_rgba32f();
        assert!(read.pixels().all(|p| p.0 == [1.0; 4]));
    }

    #[test]
    fn a_layer_that_cannot_be_written_leaves_the_old_picture() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("head.png");
        fs::write(&path, "old").expect("written");
        let mut bad = frame();
        bad.layers[0].width = 0; // PNG files have at least one column
        let error = write(&path, Format::Png8, &bad, &Film::default()).expect_err("no columns");
        assert!(error.to_string().contains("head.normal.png"), "{error}");
        assert_eq!(fs::read_to_string(&path).expect("still there"), "old");
        assert_eq!(names(folder.path()), ["head.png"]);
    }

    #[test]
    fn output_troubles_are_found_before_the_work() {
        let folder = tempfile::tempdir().expect("a folder");
        let trouble = |path: &Path| check_output(path, None).expect_err("trouble").to_string();
        assert!(trouble(&folder.path().join("nowhere/a.png")).contains("there is no folder"));
        assert!(trouble(&folder.path().join("a.tga")).contains("'.tga'"));
        fs::create_dir(folder.path().join("b.png")).expect("created");
        assert!(trouble(&folder.path().join("b.png")).contains("a folder or a device"));
        check_output(&folder.path().join("c.png"), None).expect("fine");
        assert_eq!(names(folder.path()), ["b.png"], "looking leaves nothing behind");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_folder_that_takes_no_files_is_found_out() {
        // Nobody, not even root, creates files in /proc.
        let error = check_output(Path::new("/proc/a.png"), None).expect_err("refused");
        assert!(matches!(error, FilmError::NotWritable { .. }), "{error}");
    }

    #[test]
    fn broken_pixels_are_counted() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut bad = frame();
        bad.pixels[0].x = f32::NAN;
        for (name, format) in [("a.png", Format::Png8), ("a.exr", Format::ExrHalf)] {
            let written = write(&folder.path().join(name), format, &bad, &Film::default()).expect("written");
            assert_eq!(written.broken_pixels, 1);
        }
    }
}
