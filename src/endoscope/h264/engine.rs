//! Decoder and encoder of `openh264`.

use std::{
    hash::{DefaultHasher, Hash as _, Hasher as _},
    io,
};

use h264_reader::nal::{
    Nal as _, RefNal,
    sps::{ChromaFormat, SeqParameterSet},
};
use openh264::{
    OpenH264API, decoder,
    encoder::{self, EncoderConfig, FrameRate, IntraFramePeriod, RateControlMode, SpsPpsStrategy, VuiConfig},
    formats::{YUVSlices, YUVSource as _},
};

use super::{H264Image, kind, nal_units};
use crate::{
    Colours, Damage,
    colour::{ColourMatrix, ColourPlane, ValueRange, of_planes, to_i420},
    jpeg::check_size,
};

const PARAMETERS: u8 = 7;
/// One row of this many is hashed to detect a repeated image.
const ROW_OF: usize = 4;
/// Interval between key frames: a client that joins late or lost a frame waits no longer than this.
const KEY_EVERY: u32 = 30;

/// Decodes the frames of a stream in order.
pub struct H264Decoder {
    /// Replaced after a damage, so that no corrupt state remains.
    inner: Option<decoder::Decoder>,
    colours: Option<Colours>,
    /// Waits for a key frame.
    waits: bool,
}

impl std::fmt::Debug for H264Decoder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Decoder").field("waits", &self.waits).finish_non_exhaustive()
    }
}

impl Default for H264Decoder {
    fn default() -> Self {
        Self { inner: None, colours: None, waits: true }
    }
}

impl H264Decoder {
    /// Decodes the next frame; `None` before the first key frame, or if the frame is not complete. Its pixels are
    /// computed only if `wanted`.
    ///
    /// # Errors
    /// The fault of the frame; decoding then continues at the next key frame.
    pub fn take(&mut self, unit: &[u8], is_key: bool, wanted: bool) -> Result<Option<H264Image>, Damage> {
        if self.waits && !is_key {
            return Ok(None);
        }
        let taken = self.try_take(unit, wanted);
        self.waits = taken.is_err();
        if self.waits {
            self.inner = None;
        }
        taken
    }

    fn try_take(&mut self, unit: &[u8], wanted: bool) -> Result<Option<H264Image>, Damage> {
        for nal in nal_units(unit).filter(|nal| kind(nal) == PARAMETERS) {
            self.colours = Some(parameters(nal)?);
        }
        let inner = match &mut self.inner {
            Some(inner) => inner,
            none => none.insert(decoder::Decoder::new().map_err(|error| damage(&error))?),
        };
        let Some(yuv) = inner.decode(unit).map_err(|error| damage(&error))? else { return Ok(None) };
        let (width, height) = yuv.dimensions();
        let (y_stride, u_stride, v_stride) = yuv.strides();
        let size_px = [width, height];
        check_size(size_px)?;
        let mut hasher = DefaultHasher::new();
        yuv.y().chunks(y_stride.max(1)).step_by(ROW_OF).for_each(|row| row[..width.min(row.len())].hash(&mut hasher));
        let plane = |bytes, stride| ColourPlane { bytes, stride };
        let planes = [plane(yuv.y(), y_stride), plane(yuv.u(), u_stride), plane(yuv.v(), v_stride)];
        let colours = self.colours.unwrap_or_else(|| Colours::usual(size_px));
        let image = if wanted { Some(of_planes(planes, colours, size_px)?) } else { None };
        Ok(Some(H264Image { image, hash: hasher.finish() }))
    }
}

fn undecodable(reason: &str) -> Damage {
    Damage::Undecodable { reason: reason.chars().filter(|c| !c.is_control()).take(120).collect() }
}

fn damage(error: &openh264::Error) -> Damage {
    undecodable(&error.to_string())
}

/// Returns the interpretation of the colours. Refuses parameters that would take too much memory or exceed any camera,
/// before the decoder sees them.
fn parameters(nal: &[u8]) -> Result<Colours, Damage> {
    let unreadable = || undecodable("its parameters cannot be read");
    let set = SeqParameterSet::from_bits(RefNal::new(nal, &[], true).rbsp_bits()).map_err(|_| unreadable())?;
    let (width, height) = set.pixel_dimensions().map_err(|_| unreadable())?;
    let size_px = [width as usize, height as usize];
    check_size(size_px)?;
    if set.chroma_info.chroma_format != ChromaFormat::YUV420 {
        return Err(undecodable("its colour format is not supported"));
    }
    let mut colours = Colours::usual(size_px);
    if let Some(signal) = set.vui_parameters.and_then(|vui| vui.video_signal_type) {
        if signal.video_full_range_flag {
            colours.range = ValueRange::Full;
        }
        match signal.colour_description.map(|description| description.matrix_coefficients) {
            Some(1) => colours.matrix = ColourMatrix::Bt709,
            Some(5 | 6) => colours.matrix = ColourMatrix::Bt601,
            _ => {}
        }
    }
    Ok(colours)
}

/// Encodes frames as a camera does: no frame refers to a later one, and every second has a key frame. For emulators and
/// tests.
pub struct H264Encoder {
    inner: Option<encoder::Encoder>,
    rate_hz: f64,
    size_px: [usize; 2],
}

impl std::fmt::Debug for H264Encoder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Encoder").field("size_px", &self.size_px).finish_non_exhaustive()
    }
}

const COLOURS: Colours = Colours { matrix: ColourMatrix::Bt709, range: ValueRange::Limited };

impl H264Encoder {
    /// Makes an encoder for frames at this rate.
    ///
    /// # Errors
    /// Never in a program built with the feature.
    pub fn new(rate_hz: f64) -> io::Result<Self> {
        Ok(Self { inner: None, rate_hz, size_px: [0; 2] })
    }

    /// Encodes an image with three bytes per pixel as an access unit (BT.709, limited range); `key` requests a key
    /// frame. A last odd row or column is left out.
    ///
    /// # Errors
    /// The error of the library.
    pub fn encode(&mut self, rgb: &[u8], size_px: [usize; 2], key: bool) -> io::Result<Vec<u8>> {
        let [width, height] = size_px.map(|side| side & !1);
        let i420 = if [width, height] == size_px {
            to_i420(rgb, size_px, COLOURS)
        } else {
            let rows = rgb.chunks_exact(3 * size_px[0]).take(height);
            to_i420(&rows.flat_map(|row| &row[..3 * width]).copied().collect::<Vec<u8>>(), [width, height], COLOURS)
        };
        let report = |error: openh264::Error| io::Error::other(error.to_string());
        let is_new = self.size_px != size_px;
        let inner = match &mut self.inner {
            Some(inner) if !is_new => inner,
            inner => inner.insert(
                encoder::Encoder::with_api_config(OpenH264API::from_source(), config(self.rate_hz)).map_err(report)?,
            ),
        };
        self.size_px = size_px;
        if key && !is_new {
            inner.force_intra_frame();
        }
        let (y, colours) = i420.split_at(width * height);
        let (u, v) = colours.split_at(width * height / 4);
        let source = YUVSlices::new((y, u, v), (width, height), (width, width / 2, width / 2));
        Ok(inner.encode(&source).map_err(report)?.to_vec())
    }
}

/// Returns the same quality for every frame.
fn config(rate_hz: f64) -> EncoderConfig {
    EncoderConfig::new()
        .skip_frames(false)
        .rate_control_mode(RateControlMode::Off)
        .max_frame_rate(FrameRate::from_hz(rate_hz as f32))
        .intra_frame_period(IntraFramePeriod::from_num_frames(KEY_EVERY))
        .sps_pps_strategy(SpsPpsStrategy::ConstantId)
        .scene_change_detect(false)
        .adaptive_quantization(false)
        .background_detection(false)
        .num_threads(1)
        .vui(VuiConfig::bt709())
}
