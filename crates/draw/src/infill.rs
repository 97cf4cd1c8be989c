//! Infill as SVG: the traces of layers side by side.

use crate::svg::escape;
use rayweave_analysis::infill::LayerTraces;
use rayweave_polygon::Polygons;
use std::fmt::Write;

/// A drawing of layers side by side: lines for traces, with a colour for each component.
///
/// Lengths in the drawing are those of the document. A single layer is drawn in its own coordinates, with y up. At most
/// [`InfillPicture::MAX_LAYERS`] layers are drawn.
#[derive(Clone, Debug)]
pub struct InfillPicture {
    spacing: f64,
    outline: Option<Polygons>,
    layers: Vec<LayerTraces>,
    left_out: usize,
}

/// Colours on white paper that people with any kind of colour vision can distinguish (after M. Okabe and K. Ito, 2008).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#4d4d4d"];

/// The larger side of the drawing, in pixels.
const SIDE: f64 = 900.0;

impl InfillPicture {
    /// The maximum number of layers that are drawn.
    pub const MAX_LAYERS: usize = 100;

    /// Creates a drawing without layers, for traces `spacing` apart.
    pub fn new(spacing: f64) -> InfillPicture {
        InfillPicture { spacing, outline: None, layers: Vec::new(), left_out: 0 }
    }

    /// Adds the contours of a region.
    pub fn outline(&mut self, region: &Polygons) {
        self.outline = Some(region.clone());
    }

    /// Adds a layer, unless there are too many.
    pub fn layer(&mut self, layer: LayerTraces) {
        match self.layers.len() < Self::MAX_LAYERS {
            true => self.layers.push(layer),
            false => self.left_out += 1,
        }
    }

    /// The number of layers that are not drawn because of [`InfillPicture::MAX_LAYERS`].
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// The drawing as SVG.
    pub fn to_svg(&self, title: &str) -> String {
        let page = Page::new(self);
        let scale = SIDE / page.width.max(page.height);
        let (width, height) = ((scale * page.width).ceil(), (scale * page.height).ceil());
        let [x, y, w, h] = [page.left, page.top, page.width, page.height].map(|v| page.number(v));
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"{x} {y} {w} {h}\" role=\"img\">\n<title>{}</title>\n\
             <rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            escape(title)
        );
        for (k, layer) in self.layers.iter().enumerate() {
            self.draw(layer, page.cell(k), &page, &mut svg);
        }
        svg + "</svg>\n"
    }

    /// Draws a layer with its origin at a point of the page.
    fn draw(&self, layer: &LayerTraces, [x, y]: [f64; 2], page: &Page, svg: &mut String) {
        let (x, y, line) = (page.number(x), page.number(y), page.number(0.6 * self.spacing));
        // writing to a string cannot fail
        let _ = writeln!(svg, "<g transform=\"translate({x} {y}) scale(1 -1)\" fill=\"none\">");
        let mut paths = vec![String::new(); layer.components as usize];
        for trace in &layer.traces {
            let (from, to) = (page.point(trace.from), page.point(trace.to));
            if let Some(path) = paths.get_mut(trace.component as usize) {
                let _ = write!(path, "M{from}L{to}");
            }
        }
        for (path, colour) in paths.iter().zip(COLOURS.iter().cycle()) {
            let _ = writeln!(svg, "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"{line}\"/>");
        }
        if let Some(region) = &self.outline {
            let (path, line) = (page.contours(region), page.number(page.width.max(page.height) / SIDE));
            let _ = writeln!(svg, "<path d=\"{path}\" stroke=\"#1d2733\" stroke-width=\"{line}\"/>");
        }
        svg.push_str("</g>\n");
        page.label(layer, self.layers.len() > 1, [&x, &y], svg);
    }
}

/// The arrangement of the layers, in units of the document, with y down.
struct Page {
    /// The bounding box of all traces, with y up.
    lo: [f64; 2],
    hi: [f64; 2],
    columns: usize,
    /// The distance between neighbouring layers.
    step: [f64; 2],
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    margin: f64,
    /// The number of decimals that resolve 1/2000 of the page.
    decimals: usize,
}

impl Page {
    fn new(picture: &InfillPicture) -> Page {
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let traces = picture.layers.iter().flat_map(|layer| &layer.traces);
        let corners = picture.outline.iter().flat_map(|region| region.contours().flat_map(|c| c.corners));
        for p in traces.flat_map(|trace| [trace.from, trace.to]).chain(corners.copied()) {
            for k in 0..2 {
                lo[k] = lo[k].min(p[k]);
                hi[k] = hi[k].max(p[k]);
            }
        }
        if lo[0] > hi[0] {
            (lo, hi) = ([0.0; 2], [picture.spacing; 2]);
        }
        let size = [0, 1].map(|k| (hi[k] - lo[k]).max(picture.spacing));
        let count = picture.layers.len().max(1);
        // a page about as wide as high
        let columns = ((count as f64 * size[1] / size[0]).sqrt().ceil() as usize).clamp(1, count);
        let rows = count.div_ceil(columns);
        let margin = (0.08 * size[0].max(size[1])).max(picture.spacing);
        // room for the names of several layers
        let below = if count > 1 { 1.5 * margin } else { margin };
        let step = [size[0] + margin, size[1] + below];
        let (width, height) = (columns as f64 * step[0] + margin, rows as f64 * step[1] + margin);
        // a single layer has the coordinates of the document
        let decimals = (3.3 - libm::log10(width.max(height))).ceil().clamp(0.0, 300.0) as usize;
        Page {
            lo,
            hi,
            columns,
            step,
            left: lo[0] - margin,
            top: -hi[1] - margin,
            width,
            height,
            margin,
            decimals,
        }
    }

    /// The position of the origin of a layer.
    fn cell(&self, number: usize) -> [f64; 2] {
        let cell = [number % self.columns, number / self.columns];
        [0, 1].map(|k| cell[k] as f64 * self.step[k])
    }

    /// A number without trailing zeros.
    fn number(&self, value: f64) -> String {
        let text = format!("{value:.*}", self.decimals);
        let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        if short == "-0" { "0".to_owned() } else { short.to_owned() }
    }

    fn point(&self, p: [f64; 2]) -> String {
        format!("{} {}", self.number(p[0]), self.number(p[1]))
    }

    fn contours(&self, region: &Polygons) -> String {
        let contour = |corners: &[[f64; 2]]| {
            let points: Vec<String> = corners.iter().map(|&p| self.point(p)).collect();
            format!("M{}Z", points.join("L"))
        };
        region.contours().map(|c| contour(c.corners)).collect()
    }

    /// Draws the name of a layer below it.
    fn label(&self, layer: &LayerTraces, is_one_of_many: bool, [x, y]: [&str; 2], svg: &mut String) {
        if !is_one_of_many {
            return;
        }
        let size = self.number(0.6 * self.margin);
        let at = self
            .point([0.5 * (self.lo[0] + self.hi[0]), 0.9 * self.margin - self.lo[1]])
            .replace(' ', "\" y=\"");
        let (number, z) = (layer.layer, self.number(layer.z));
        let _ = writeln!(
            svg,
            "<text transform=\"translate({x} {y})\" x=\"{at}\" font-size=\"{size}\" font-family=\"sans-serif\" \
             text-anchor=\"middle\" fill=\"#46525f\">{number}: z = {z}</text>"
        );
    }
}
