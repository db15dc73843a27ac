//! Which adapter a run takes, decided on plain values so that the rule can be tested without a driver.

use std::fmt;
use std::str::FromStr;

use crate::error::{Error, Result};

/// Environment variable that, set to `1`, makes a missing adapter an error even where the CPU twins would do.
pub const REQUIRE_GPU: &str = "HOMEO_REQUIRE_GPU";

/// What the user asked for with `--device`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A hardware GPU if there is one, otherwise the CPU twins.
    #[default]
    Auto,
    /// The CPU twins.
    Cpu,
    /// Any adapter, hardware before software; none is an error.
    Gpu,
    /// The first adapter whose name contains this text (case does not matter); none is an error.
    Named(String),
}

impl FromStr for DeviceChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        Ok(match text {
            "auto" => DeviceChoice::Auto,
            "cpu" => DeviceChoice::Cpu,
            "gpu" => DeviceChoice::Gpu,
            name => DeviceChoice::Named(name.to_owned()),
        })
    }
}

/// What an adapter runs on; the order is the order of preference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// A GPU with its own memory.
    Discrete,
    /// A GPU that shares the processor's memory.
    Integrated,
    /// A GPU behind a virtual machine's door.
    Virtual,
    /// The driver does not say.
    Unknown,
    /// A software driver on the processor, such as llvmpipe.
    Software,
}

impl AdapterKind {
    /// True for a driver that runs on the processor.
    pub fn is_software(self) -> bool {
        self == AdapterKind::Software
    }
}

impl fmt::Display for AdapterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            AdapterKind::Discrete => "discrete GPU",
            AdapterKind::Integrated => "integrated GPU",
            AdapterKind::Virtual => "virtual GPU",
            AdapterKind::Unknown => "unknown type",
            AdapterKind::Software => "software",
        })
    }
}

/// One adapter as `homeo devices` lists it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterInfo {
    /// The adapter's name as its driver gives it.
    pub name: String,
    /// Hardware or software.
    pub kind: AdapterKind,
    /// The graphics interface: `vulkan`, `metal`, `dx12`.
    pub backend: String,
    /// Driver name and version, as far as known.
    pub driver: String,
}

impl fmt::Display for AdapterInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {}", self.name, self.kind, self.backend)?;
        if !self.driver.is_empty() {
            write!(f, ", {}", self.driver)?;
        }
        f.write_str(")")
    }
}

/// The outcome of [`select`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Pick {
    /// The CPU twins, with a line for the report when an adapter might have been expected.
    Cpu(Option<String>),
    /// The adapter at this place of the list.
    Adapter(usize),
}

/// Applies `choice` to the adapters at hand; `required` is the state of [`REQUIRE_GPU`].
///
/// A software adapter is slower than the CPU twins and gives the same results, so `auto` never takes one.
/// Fails with a device error (exit code 5) when an adapter is asked for or required and there is none.
pub fn select(choice: &DeviceChoice, adapters: &[AdapterInfo], required: bool) -> Result<Pick> {
    let best = |wanted: &dyn Fn(&AdapterInfo) -> bool| {
        let fitting = adapters.iter().enumerate().filter(|(_, a)| wanted(a));
        fitting.min_by_key(|(i, a)| (a.kind, *i)).map(|(i, _)| Pick::Adapter(i))
    };
    match choice {
        DeviceChoice::Cpu => Ok(Pick::Cpu(None)),
        DeviceChoice::Gpu => best(&|_| true).ok_or_else(none_found),
        DeviceChoice::Named(name) => {
            let name = name.to_lowercase();
            best(&|a| a.name.to_lowercase().contains(&name)).ok_or_else(|| not_named(&name, adapters))
        }
        DeviceChoice::Auto if required && adapters.is_empty() => Err(none_found()),
        DeviceChoice::Auto => {
            Ok(best(&|a| !a.kind.is_software()).unwrap_or_else(|| Pick::Cpu(Some(fallback(adapters)))))
        }
    }
}

fn none_found() -> Error {
    Error::device("no compute adapter found")
        .remedy("install a Vulkan driver (Debian: mesa-vulkan-drivers libvulkan1), or run with --device cpu")
}

fn not_named(name: &str, adapters: &[AdapterInfo]) -> Error {
    let known: Vec<&str> = adapters.iter().map(|a| a.name.as_str()).collect();
    let remedy = match known.as_slice() {
        [] => "no adapter was found; run with --device cpu".to_owned(),
        names => format!("take one of: {}; or auto, cpu, gpu", names.join("; ")),
    };
    Error::device("no compute adapter of that name").at(format!("\"{name}\"")).remedy(remedy)
}

fn fallback(adapters: &[AdapterInfo]) -> String {
    match adapters.first() {
        None => "no compute adapter found: computed on the CPU".to_owned(),
        Some(a) => format!("only a software adapter found ({}): computed on the CPU", a.name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;

    fn adapter(name: &str, kind: AdapterKind) -> AdapterInfo {
        AdapterInfo { name: name.into(), kind, backend: "vulkan".into(), driver: String::new() }
    }

    fn machine() -> Vec<AdapterInfo> {
        vec![
            adapter("llvmpipe (LLVM 15)", AdapterKind::Software),
            adapter("Small Graphics", AdapterKind::Integrated),
            adapter("Big Graphics", AdapterKind::Discrete),
        ]
    }

    #[test]
    fn auto_takes_hardware_only() {
        assert_eq!(select(&DeviceChoice::Auto, &machine(), false), Ok(Pick::Adapter(2)));
        for required in [false, true] {
            let Ok(Pick::Cpu(Some(note))) = select(&DeviceChoice::Auto, &machine()[..1], required) else {
                panic!("a software adapter must be left to those who name it");
            };
            assert!(note.contains("llvmpipe"), "{note}");
        }
    }

    #[test]
    fn gpu_and_names_take_software_too() {
        assert_eq!(select(&DeviceChoice::Gpu, &machine(), false), Ok(Pick::Adapter(2)));
        assert_eq!(select(&DeviceChoice::Gpu, &machine()[..1], false), Ok(Pick::Adapter(0)));
        assert_eq!(select(&"LLVMpipe".parse().unwrap(), &machine(), false), Ok(Pick::Adapter(0)));
        assert_eq!(select(&"graphics".parse().unwrap(), &machine(), false), Ok(Pick::Adapter(2)));
    }

    #[test]
    fn a_missing_device_is_an_error_only_where_one_is_wanted() {
        let kind = |choice: &str, required| select(&choice.parse().unwrap(), &[], required).map_err(|e| e.kind);
        assert!(matches!(kind("auto", false), Ok(Pick::Cpu(Some(_)))));
        assert_eq!(kind("auto", true), Err(ErrorKind::Device));
        assert_eq!(kind("gpu", false), Err(ErrorKind::Device));
        assert_eq!(kind("nvidia", false), Err(ErrorKind::Device));
        assert_eq!(kind("cpu", true), Ok(Pick::Cpu(None)));
    }

    #[test]
    fn an_unknown_name_lists_the_known_ones() {
        let error = select(&"volcano".parse().unwrap(), &machine(), false).unwrap_err();
        assert!(error.remedy.contains("Small Graphics") && error.element.contains("volcano"), "{error}");
        assert_eq!(error.kind.exit_code(), 5);
    }
}
