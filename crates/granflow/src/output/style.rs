//! How a map is shown: colours over a range of values; as a layer style of QGIS.

use granflow_figures::Colours;
use std::fmt::Write as _;

/// Colours that a layer style names; between them they are mixed.
const STOPS: u32 = 16;

/// How a map is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// What is shown.
    pub label: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// The scale of colours.
    pub colours: Colours,
    /// Nothing is shown of values up to this.
    pub above: f64,
    /// The values at both ends of the scale.
    pub range: [f64; 2],
}

impl Style {
    /// The layer style of QGIS (3.x) for a raster with one band: the colours of the figure, mixed between named values, and nothing where
    /// the figure shows nothing.
    #[must_use]
    pub fn qml(&self) -> String {
        let [low, high] = self.range;
        let decimals = decimals((high - low) / f64::from(STOPS));
        let mut items = String::new();
        for k in 0..=STOPS {
            let share = f64::from(k) / f64::from(STOPS);
            let value = low + share * (high - low);
            let [r, g, b] = self.colours.at(share);
            let label = escaped(&format!("{value:.decimals$} {}", self.unit));
            let label = label.trim_end();
            let _ = writeln!(
                items,
                "          <item value=\"{value:?}\" alpha=\"255\" color=\"#{r:02x}{g:02x}{b:02x}\" label=\"{label}\"/>"
            ); // a String takes everything
        }
        let above = self.above;
        format!(
            r#"<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>
<qgis version="3.22" styleCategories="Symbology|Legend">
  <pipe>
    <rasterrenderer type="singlebandpseudocolor" band="1" opacity="0.85" alphaBand="-1" nodataColor="" classificationMin="{low:?}" classificationMax="{high:?}">
      <rasterTransparency>
        <singleValuePixelList>
          <pixelListEntry min="-1e+30" max="{above:?}" percentTransparent="100"/>
        </singleValuePixelList>
      </rasterTransparency>
      <rastershader>
        <colorrampshader colorRampType="INTERPOLATED" classificationMode="1" clip="0" minimumValue="{low:?}" maximumValue="{high:?}" labelPrecision="{decimals}">
{items}          <rampLegendSettings prefix="" suffix=" {unit}" direction="0" orientation="2" minimumLabel="" maximumLabel="" useContinuousLegend="1"/>
        </colorrampshader>
      </rastershader>
    </rasterrenderer>
    <brightnesscontrast brightness="0" contrast="0" gamma="1"/>
    <rasterresampler maxOversampling="2"/>
  </pipe>
  <blendMode>0</blendMode>
</qgis>
"#,
            unit = escaped(&self.unit)
        )
    }
}

/// Decimals that show two digits of a step between values.
fn decimals(step: f64) -> usize {
    if step > 0.0 { (1.0 - step.log10().floor()).clamp(0.0, 12.0) as usize } else { 0 }
}

/// A text as it may stand in an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colours_of_a_layer_are_those_of_the_figure() {
        let style = Style {
            label: "peak thickness".to_owned(),
            unit: "<m>".to_owned(),
            colours: Colours::Thickness,
            above: 0.01,
            range: [0.0, 4.0],
        };
        let qml = style.qml();
        for share in [0.0, 0.5, 1.0] {
            let [r, g, b] = Colours::Thickness.at(share);
            let item = format!("value=\"{:?}\" alpha=\"255\" color=\"#{r:02x}{g:02x}{b:02x}\"", 4.0 * share);
            assert!(qml.contains(&item), "{item}");
        }
        assert!(
            qml.contains("max=\"0.01\" percentTransparent=\"100\"") && qml.contains("suffix=\" &lt;m>\"")
        );
        assert_eq!(qml.matches("<item ").count(), 17);
        assert!(qml.contains("label=\"0.25 &lt;m>\""));
        let thin = Style { range: [0.0, 1e-3], unit: String::new(), ..style }.qml();
        assert!(thin.contains("label=\"0.000500\""), "{thin}");
    }
}
