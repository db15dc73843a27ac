//! `homeo devices`: compute adapters, and which one is taken.

use super::args::Global;
use super::console::Console;
use crate::error::Result;
use crate::gpu::{AdapterInfo, DeviceChoice, Pick, adapters, select};
use serde_json::json;
use std::process::ExitCode;

/// Runs the command; `--device` asks what that choice would take instead of `auto`.
pub fn run(global: &Global, console: &Console) -> Result<ExitCode> {
    let adapters = adapters();
    let Ok(choice) = global.device.parse::<DeviceChoice>();
    let pick = select(&choice, &adapters, false)?;
    let taken = match &pick {
        Pick::Adapter(i) => Some(*i),
        Pick::Cpu(_) => None,
    };
    let entry = |(i, a): (usize, &AdapterInfo)| {
        json!({
            "name": a.name,
            "kind": a.kind.to_string(),
            "software": a.kind.is_software(),
            "backend": a.backend,
            "driver": a.driver,
            "taken": taken == Some(i),
        })
    };
    let entries: Vec<_> = adapters.iter().enumerate().map(entry).collect();
    let value = json!({ "choice": global.device, "cpu_taken": taken.is_none(), "adapters": entries });
    console.result(&value, || listing(&adapters, taken, &global.device));
    if let Pick::Cpu(Some(note)) = &pick {
        console.note(note);
    }
    Ok(ExitCode::SUCCESS)
}

fn listing(adapters: &[AdapterInfo], taken: Option<usize>, choice: &str) -> String {
    let line = |is_taken: bool, text: String| format!("{} {text}\n", if is_taken { '*' } else { ' ' });
    let cpu = line(taken.is_none(), format!("CPU ({} threads)", rayon::current_num_threads()));
    let rest = adapters.iter().enumerate().map(|(i, a)| line(taken == Some(i), a.to_string()));
    cpu + &rest.collect::<String>() + &format!("* is what --device {choice} takes\n")
}
