//! ATI Net F/T sensors: records over UDP (raw data transfer), counts and units over HTTP.
//!
//! Sources: ATI's manual 9620-05-NET FT ("UDP interface using RDT"), and the public drivers that read `netftapi2.xml`. Not
//! tried on a real sensor.

pub mod codec;
mod configuration;
mod driver;
mod settings;
#[cfg(test)]
mod tests;

pub use configuration::AtiConfiguration;
pub use driver::AtiDriver;
pub use settings::AtiSettings;
