//! Pictures one after the other in one file: animated PNG, which every browser shows.

use crate::picture::Picture;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// An animated PNG on its way. Holds the bytes of the file, compressed, and no picture.
pub struct Animation {
    writer: png::Writer<Shared>,
    bytes: Shared,
    size: [u32; 2],
}

/// Bytes that can be had again when the encoder, which owns its writer, is done.
#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Animation {
    /// So many frames of a size in pixels, at so many a second, again and again.
    pub fn new([width, height]: [u32; 2], frames: u32, frames_per_second: u16) -> io::Result<Self> {
        let bytes = Shared::default();
        let to = bytes.clone();
        let mut encoder = png::Encoder::new(to, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_animated(frames, 0)?;
        encoder.set_frame_delay(1, frames_per_second.max(1))?;
        Ok(Self { writer: encoder.write_header()?, bytes, size: [width, height] })
    }

    /// The next frame; refused where it has another size.
    pub fn add(&mut self, picture: &Picture) -> io::Result<()> {
        if [picture.width, picture.height] != self.size {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "a frame of another size"));
        }
        Ok(self.writer.write_image_data(&picture.rgba)?)
    }

    /// The file; refused where frames are missing.
    pub fn finish(self) -> io::Result<Vec<u8>> {
        self.writer.finish()?;
        let mut bytes = self.bytes.0.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(std::mem::take(&mut *bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_come_back_in_their_order() {
        let picture = |red: u8| Picture { width: 3, height: 2, rgba: [red, 0, 0, 255].repeat(6) };
        let mut animation = Animation::new([3, 2], 3, 10).unwrap();
        for red in [10, 20, 30] {
            animation.add(&picture(red)).unwrap();
        }
        assert!(animation.add(&Picture { width: 1, ..picture(0) }).is_err());
        let bytes = animation.finish().unwrap();
        let mut reader = png::Decoder::new(io::Cursor::new(&bytes)).read_info().unwrap();
        assert_eq!(reader.info().animation_control().map(|control| control.num_frames), Some(3));
        let mut frame = vec![0; reader.output_buffer_size().unwrap()];
        for red in [10, 20, 30] {
            reader.next_frame(&mut frame).unwrap();
            assert_eq!(frame[0], red);
        }
    }
}
