//! Tables read back by parsers that are not ours.
#![allow(clippy::unwrap_used, reason = "tests")]

use super::*;
use crate::{Dipole, FitMethod, Medium, Profile, fit, presets};
use naga::front::{glsl as glsl_in, wgsl as wgsl_in};
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn rgb() -> KernelTable {
    let kernel = presets::find("three-layer-skin").unwrap().kernel(6).unwrap();
    KernelTable::rgb("three-layer-skin", "a published kernel", &kernel)
}

fn single() -> KernelTable {
    let dipole = Dipole::new(&Medium::new(0.032, 0.74, 1.3).unwrap()).unwrap();
    KernelTable::from_fit("skin1 red", "dipole", &fit(&dipole, 4, FitMethod::Energy).unwrap())
}

fn validate(module: &naga::Module) {
    Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(module).unwrap();
}

/// Numbers of a constant, in their order, flattened.
fn constant(module: &naga::Module, name: &str) -> Vec<f64> {
    let found = module.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name));
    let mut numbers = Vec::new();
    flatten(module, found.unwrap_or_else(|| panic!("{name} is there")).1.init, &mut numbers);
    numbers
}

fn flatten(module: &naga::Module, handle: naga::Handle<naga::Expression>, into: &mut Vec<f64>) {
    match &module.global_expressions[handle] {
        naga::Expression::Literal(naga::Literal::F32(value)) => into.push(f64::from(*value)),
        naga::Expression::Literal(naga::Literal::U32(value)) => into.push(f64::from(*value)),
        naga::Expression::Compose { components, .. } => {
            components.iter().for_each(|part| flatten(module, *part, into));
        }
        other => panic!("not a number: {other:?}"),
    }
}

fn same(read: &[f64], written: impl Iterator<Item = f64>) {
    let written: Vec<f64> = written.collect();
    assert_eq!(read.len(), written.len());
    // A float of single precision, printed so that it reads back the same: half an ulp of 2^-23.
    read.iter().zip(&written).for_each(|(r, w)| assert!((r - w).abs() <= 6e-8 * w.abs(), "{r} {w}"));
}

#[test]
fn wgsl_parses_validates_and_holds_the_numbers() {
    for table in [rgb(), single()] {
        let module = wgsl_in::parse_str(&table.to_wgsl()).unwrap();
        validate(&module);
        same(&constant(&module, "CUTIS_VARIANCES_MM2"), table.variances_mm2.iter().copied());
        assert_eq!(constant(&module, "CUTIS_GAUSSIANS"), [table.variances_mm2.len() as f64]);
        let weights = constant(&module, "CUTIS_WEIGHTS");
        match &table.weights {
            Weights::Single(w) => same(&weights, w.iter().copied()),
            Weights::Rgb(w) => same(&weights, w.iter().flatten().copied()),
        }
        assert!(
            module
                .functions
                .iter()
                .any(|(_, f)| f.name.as_deref() == Some("cutis_diffuse_reflectance_per_mm2"))
        );
    }
}

#[test]
fn glsl_parses_and_validates() {
    for table in [rgb(), single()] {
        let red = if matches!(table.weights, Weights::Rgb(_)) { ".x" } else { "" };
        let shader = format!(
            "#version 450\n{}layout(location = 0) out float o;\nvoid main() {{ o = cutis_diffuse_reflectance_per_mm2(1.0){red}; }}\n",
            table.to_glsl()
        );
        let options = glsl_in::Options::from(naga::ShaderStage::Fragment);
        validate(&glsl_in::Frontend::default().parse(&options, &shader).unwrap());
    }
}

#[test]
fn hlsl_is_the_same_table_in_other_words() {
    // No compiler looks at it here: brackets in pairs, and the numbers of the checked GLSL in the same order.
    for table in [rgb(), single()] {
        let (hlsl, glsl) = (table.to_hlsl(), table.to_glsl());
        for (open, close) in [('{', '}'), ('(', ')'), ('[', ']')] {
            assert_eq!(hlsl.matches(open).count(), hlsl.matches(close).count(), "{hlsl}");
        }
        let numbers = |text: &str| -> Vec<String> {
            let body = text.lines().filter(|line| !line.starts_with("//") && line.starts_with("    "));
            let of_table = body.filter(|line| !line.contains(';') && !line.contains("for"));
            let bare = of_table.flat_map(|line| {
                line.split(|c: char| !"0123456789.e-".contains(c)).map(str::to_owned).collect::<Vec<_>>()
            });
            bare.filter(|word| word.parse::<f64>().is_ok() && word.contains(['.', 'e'])).collect()
        };
        assert_eq!(numbers(&hlsl), numbers(&glsl));
        assert!(numbers(&hlsl).len() >= 8);
    }
}

#[test]
fn csv_and_json_keep_every_digit() {
    let table = rgb();
    let rows: Vec<Vec<f64>> = table
        .to_csv()
        .lines()
        .filter(|l| !l.starts_with('#'))
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let json: serde_json::Value = serde_json::from_str(&table.to_json()).unwrap();
    let Weights::Rgb(weights) = &table.weights else { panic!("three channels") };
    for (i, row) in rows.iter().enumerate() {
        assert_eq!(row[0], table.variances_mm2[i]);
        assert_eq!(row[1..], weights[i]);
        assert_eq!(json["variances_mm2"][i].as_f64().unwrap(), row[0]);
        assert_eq!(json["weights"][i][2].as_f64().unwrap(), row[3]);
    }
    assert_eq!(rows.len(), 6);
    assert!((json["energy"][1].as_f64().unwrap() - 1.0).abs() < 1e-12);
}

#[test]
fn remarks_tell_material_source_unit_energy_and_error() {
    let text = single().to_wgsl();
    let told = ["skin1 red", "Source: dipole", "mm^2", "0.435931", "0.4554 %"];
    assert!(told.iter().all(|words| text.contains(words)), "{text}");
    assert!(rgb().to_glsl().contains("not a fit"));
}

#[test]
fn a_hostile_name_stays_in_its_comment() {
    let dipole = Dipole::new(&Medium::new(0.1, 1.0, 1.4).unwrap()).unwrap();
    let sum = fit(&dipole, 2, FitMethod::Energy).unwrap().sum;
    let table = KernelTable::single("x\nfn evil() {}\r\u{2028}", "y\n*/ #error", &sum);
    let module = wgsl_in::parse_str(&table.to_wgsl()).unwrap();
    assert_eq!(module.functions.len(), 1);
    assert!(table.to_csv().lines().all(|l| l.starts_with('#')
        || l.starts_with("variance")
        || l.starts_with(|c: char| c.is_ascii_digit())));
    assert!(dipole.total() > 0.0);
}
