//! A layer in words: `mu_a=0.1,mu_s=9,g=0.75,n=1.4,d=0.2`.

use cutis_optics::simulate::Layer;
use miette::{bail, miette};

/// Reads a layer. `g` is 0, `n` is 1 and `d` is infinite unless given; `mu_a` and `mu_s` must be.
pub fn parse_layer(words: &str) -> miette::Result<Layer> {
    let mut given: [Option<f64>; 5] = [None; 5];
    const KEYS: [&str; 5] = ["mu_a", "mu_s", "g", "n", "d"];
    for pair in words.split(',') {
        let Some((key, value)) = pair.split_once('=') else {
            bail!("--layer \"{words}\": `{pair}` is not of the form key=value");
        };
        let Some(k) = KEYS.iter().position(|&known| known == key.trim()) else {
            bail!("--layer \"{words}\": `{}` is not known; mu_a, mu_s, g, n and d are", key.trim());
        };
        let number = value.trim().parse::<f64>();
        let number =
            number.map_err(|_| miette!("--layer \"{words}\": `{}` is not a number", value.trim()))?;
        if given[k].replace(number).is_some() {
            bail!("--layer \"{words}\": `{}` is given twice", KEYS[k]);
        }
    }
    let required =
        |k: usize| given[k].ok_or_else(|| miette!("--layer \"{words}\": `{}` is missing", KEYS[k]));
    Ok(Layer {
        sigma_a_per_mm: required(0)?,
        sigma_s_per_mm: required(1)?,
        g: given[2].unwrap_or(0.0),
        refractive_index: given[3].unwrap_or(1.0),
        thickness_mm: given[4].unwrap_or(f64::INFINITY),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layer_is_read_with_its_defaults() {
        let layer = parse_layer("mu_s=9, mu_a=0.5,g=-0.2,n=1.4,d=inf").expect("is well formed");
        assert_eq!((layer.sigma_a_per_mm, layer.sigma_s_per_mm, layer.g), (0.5, 9.0, -0.2));
        assert_eq!((layer.refractive_index, layer.thickness_mm), (1.4, f64::INFINITY));
        let plain = parse_layer("mu_a=0,mu_s=1").expect("is well formed");
        assert_eq!((plain.g, plain.refractive_index, plain.thickness_mm), (0.0, 1.0, f64::INFINITY));
    }

    #[test]
    fn nonsense_is_named() {
        for (words, told) in [
            ("mu_a=1", "`mu_s` is missing"),
            ("mu_a=1,mu_s", "`mu_s` is not of the form key=value"),
            ("mu_a=1,mus=2", "`mus` is not known"),
            ("mu_a=one,mu_s=2", "`one` is not a number"),
            ("mu_a=1,mu_s=2,mu_a=3", "`mu_a` is given twice"),
        ] {
            let error = parse_layer(words).expect_err("is nonsense").to_string();
            assert!(error.contains(told), "{error}");
        }
    }
}
