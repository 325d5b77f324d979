//! The process models that rules name: files beside the rules, beside the application, or on the
//! search path.

use std::path::{Path, PathBuf};

use system_model::process_model::ProcessModel;
use system_model::rules::FaultRules;
use system_model::specification::ApplicationSpecification;
use system_profile::load_process_model;

use super::{Failed, errors_on_terminal, exit_code, problems, show};

/// Loads every model once, by the name that the rules use.
pub(super) fn load(
    rules: &FaultRules,
    application: &ApplicationSpecification,
    search_path: &[PathBuf],
) -> Result<Vec<(String, ProcessModel)>, Failed> {
    let mut models: Vec<(String, ProcessModel)> = Vec::new();
    for monitor in &rules.monitors {
        let name = &monitor.rule.value.model;
        let is_component = application.components.iter().any(|it| it.name == *name);
        if is_component || models.iter().any(|(known, _)| known == name) {
            continue;
        }
        let beside = [&monitor.rule.place.file, &application.file];
        let folders = beside
            .iter()
            .filter_map(|file| file.parent())
            .chain(search_path.iter().map(PathBuf::as_path));
        let Some(path) = find(name, folders) else {
            return Err(Failed {
                code: exit_code::FILE,
                text: format!(
                    "{}: no model '{name}' beside the rules, beside the application or on \
                     --search-path\n  help: a process model is a file with the root <process_model>",
                    monitor.rule.place
                ),
            });
        };
        let outcome = load_process_model(&path);
        let Some(model) = outcome.model else {
            return Err(Failed {
                code: exit_code::PROFILE,
                text: problems::render(&outcome.problems, errors_on_terminal()),
            });
        };
        show(&outcome.problems);
        models.push((name.clone(), model));
    }
    Ok(models)
}

fn find<'folder>(name: &str, mut folders: impl Iterator<Item = &'folder Path>) -> Option<PathBuf> {
    folders.find_map(|folder| {
        let named = [folder.join(name), folder.join(format!("{name}.xml"))];
        named.into_iter().find(|path| path.is_file())
    })
}
