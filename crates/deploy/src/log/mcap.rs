use std::io;
use super::{About, Output};
use crate::record::{Event, Step};
pub(super) struct McapLog;
impl McapLog {
    pub(super) fn begin(_: Box<dyn Output>, _: &About, _: u64) -> io::Result<Self> { Ok(Self) }
    pub(super) fn step(&mut self, _: &Step) -> io::Result<()> { Ok(()) }
    pub(super) fn event(&mut self, t: f64, e: u32, ev: Event) -> io::Result<()> { eprintln!("{t:.3} {e} {:?}", ev); Ok(()) }
    pub(super) fn flush(&mut self) -> io::Result<()> { Ok(()) }
    pub(super) fn finish(&mut self) -> io::Result<()> { Ok(()) }
}
