//! Prints as JSON what the readers make of a file, or why they refuse it: for comparing them with other programs.
//!
//! `read raster FILE [CRS]` prints a raster, `read release FILE DEM ATTRIBUTE` the volume of a release \[m^3\], `read systems` two
//! definitions to a line of standard input, apart by a tab, as same, different or unknown; `read scales` the largest and smallest scale of a
//! map at a place, both with its system on a line of standard input.

use granflow_geo::raster::{Comparison, Crs, Raster, Reading};
use granflow_geo::release::{Layer, Thickness};
use std::error::Error;
use std::io::BufRead;
use std::path::Path;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let answer =
        match words[..] {
            ["raster", file] => raster(file, None),
            ["raster", file, crs] => raster(file, Some(crs)),
            ["release", file, dem, attribute] => release(file, dem, attribute),
            ["systems"] => systems(),
            ["scales"] => scales(),
            _ => Err("read raster FILE [CRS] | read release FILE DEM ATTRIBUTE | read systems | read scales"
                .into()),
        };
    match answer {
        Ok(text) => println!("{text}"),
        Err(error) => println!("{}", serde_json::json!({ "refused": error.to_string() })),
    }
}

fn raster(file: &str, crs: Option<&str>) -> Result<String, Box<dyn Error>> {
    let crs = crs.map(Crs::parse).transpose()?;
    let Reading { raster, notes, .. } = Reading::of(Path::new(file), crs.as_ref())?;
    let Raster { columns, rows, west, south, cell, values, crs } = &*raster;
    let notes: Vec<String> = notes.iter().map(ToString::to_string).collect();
    let values: Vec<Option<f64>> = values.iter().map(|z| (!z.is_nan()).then_some(*z)).collect();
    let crs = crs.as_ref().map(Crs::describe);
    Ok(serde_json::json!({
        "columns": columns, "rows": rows, "west": west, "south": south, "cell": cell, "values": values, "crs": crs,
        "notes": notes,
    })
    .to_string())
}

fn release(file: &str, dem: &str, attribute: &str) -> Result<String, Box<dyn Error>> {
    let dem = Raster::read(Path::new(dem))?;
    let layer = Layer::read(Path::new(file))?;
    let notes: Vec<String> = layer.notes(&dem).iter().map(ToString::to_string).collect();
    let thickness = layer.thickness(&Thickness::Attribute(attribute.into()), &dem)?;
    let volume = thickness.iter().map(|(_, h)| h).sum::<f64>() * dem.cell * dem.cell;
    Ok(serde_json::json!({ "volume": volume, "notes": notes }).to_string())
}

fn systems() -> Result<String, Box<dyn Error>> {
    let mut answers = Vec::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let (a, b) = line.split_once('\t').ok_or("two definitions, apart by a tab")?;
        answers.push(match (Crs::parse(a), Crs::parse(b)) {
            (Ok(a), Ok(b)) => match a.compare(&b) {
                Comparison::Same => "same".to_owned(),
                Comparison::Different(what) => format!("different: {what}"),
                Comparison::Unknown(what) => format!("unknown: {what}"),
            },
            (Err(error), _) | (_, Err(error)) => format!("refused: {error}"),
        });
    }
    Ok(serde_json::json!(answers).to_string())
}

fn scales() -> Result<String, Box<dyn Error>> {
    let mut answers = Vec::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let parts: Vec<&str> = line.split('\t').collect();
        let [crs, x, y] = parts[..] else { return Err("a system, x and y, apart by tabs".into()) };
        answers.push(Crs::parse(crs)?.factors([x.parse()?, y.parse()?]));
    }
    Ok(serde_json::json!(answers).to_string())
}
