//! Models as texts.

use std::ffi::c_int;

use mujoco_rs::prelude::MjEditError;

use super::super::BuildError;
use super::Spec;

/// Digits of a number. The most at which 0.1 is written as it was read.
const DIGITS: c_int = 15;

#[expect(unsafe_code, reason = "the engine writes 6 digits, and its headers have no way to ask for more")]
unsafe extern "C" {
    /// The digits of numbers in texts that the engine writes on this thread. The engine's own tests use it; should a later
    /// engine lack it, programs do not link.
    #[link_name = "_mjPRIVATE__set_xml_precision"]
    fn set_xml_precision(digits: c_int);
}

impl Spec {
    /// The model as one MJCF text, as it is now, with numbers of 15 digits. It asks for the same files as the model does.
    ///
    /// # Errors
    ///
    /// Those of [`Self::compile`].
    pub fn to_mjcf(&mut self) -> Result<String, BuildError> {
        // What is written is what was compiled.
        let (_, copy) = self.model()?;
        let spec = copy.as_ref().unwrap_or(&self.inner);
        #[expect(unsafe_code, reason = "see above")]
        // SAFETY: the function writes a number that belongs to this thread and nothing else.
        unsafe {
            set_xml_precision(DIGITS);
        }
        let mut size = 1 << 16;
        loop {
            match spec.save_xml_string(size) {
                Ok(text) => return Ok(self.mount.plain(&text)),
                Err(MjEditError::XmlBufferTooSmall { required_size }) if required_size >= size => {
                    size = required_size + 1;
                }
                Err(error) => return Err(BuildError::Write(self.mount.plain(&error.to_string()))),
            }
        }
    }
}
