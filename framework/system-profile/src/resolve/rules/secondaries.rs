//! What takes a component's place: that it is there, that it fits, and that it is something else.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use system_model::profile::{ComponentProfile, Profile};
use system_model::rules::Secondary;
use system_model::specification::ComponentSpecification;

use super::names::{Names, description};
use crate::problem::Severity;
use crate::readers::rules::DeclaredSecondary;
use crate::resolve::instances;
use crate::resolve::references::{inside, near_help};
use crate::resolve::{Assembly, LoadedFile};
use crate::suggest::quoted;

/// The secondaries of a component in the order written.
pub(super) fn resolve(
    assembly: &mut Assembly<'_>,
    names: &Names<'_>,
    component: usize,
    declared: &[DeclaredSecondary],
) -> Vec<Secondary> {
    let primary = names.specification(component);
    let mut used = vec![identity(&primary.profile)];
    let mut resolved = Vec::new();
    for secondary in declared {
        let Some(file) = find(assembly, names, primary, secondary) else {
            continue;
        };
        let Some(profile) = component_profile(assembly, secondary, &file) else {
            continue;
        };
        if used.contains(&file.identity) {
            report_same(assembly, primary, secondary, file.identity == used[0]);
            continue;
        }
        used.push(file.identity.clone());
        let specification = stand_in(assembly, component, primary, secondary, profile);
        check_ports(assembly, names, component, secondary, &specification);
        resolved.push(Secondary {
            specification,
            preload: secondary.preload,
        });
    }
    resolved
}

fn identity(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// The file of a secondary; an error if there is none, for it would be missed only in an emergency.
fn find(
    assembly: &mut Assembly<'_>,
    names: &Names<'_>,
    primary: &ComponentSpecification,
    secondary: &DeclaredSecondary,
) -> Option<Rc<LoadedFile>> {
    let reference = &secondary.reference;
    let Some(relative) = inside(&reference.value) else {
        assembly.report_at(
            Severity::Error,
            &reference.place,
            format!(
                "`{}` is a reference outside the search path",
                quoted(&reference.value)
            ),
            "references are relative and have no `..`; add a folder to the search path",
        );
        return None;
    };
    let folders = folders(assembly, names, primary, &reference.place.file);
    let found = folders.iter().map(|folder| folder.join(&relative));
    let found = found.into_iter().find(|path| path.is_file());
    if found.is_none() {
        assembly.report_at(
            Severity::Error,
            &reference.place,
            format!(
                "the secondary cannot be reached: there is no file `{}`",
                quoted(&reference.value)
            ),
            near_help(&relative, &folders),
        );
    }
    Some(assembly.files.open(&found?))
}

/// Beside the file that names it, where the primary is, where the application looks for its own
/// components, and in the search paths.
fn folders(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    primary: &ComponentSpecification,
    rules: &Path,
) -> Vec<PathBuf> {
    let parent = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let own = parent(rules);
    let mut folders = vec![
        own.clone(),
        own.join("../components"),
        own.join("../profiles/components"),
    ];
    folders.push(parent(&primary.profile));
    folders.push(parent(&names.application.file).join("../components"));
    folders.extend(assembly.options.search_paths.iter().cloned());
    folders
}

fn component_profile<'f>(
    assembly: &Assembly<'_>,
    secondary: &DeclaredSecondary,
    file: &'f LoadedFile,
) -> Option<&'f ComponentProfile> {
    match &file.profile {
        Some(Profile::Component(profile)) if !file.document.has_errors() => Some(profile),
        _ => {
            let what = match file.profile {
                Some(Profile::Component(_)) => "its profile has errors".to_owned(),
                _ => {
                    let root = quoted(file.document.root_name().unwrap_or_default());
                    format!("<{root}> is no component profile")
                }
            };
            assembly.report_at(
                Severity::Error,
                &secondary.reference.place,
                format!("the secondary cannot be used: {what}"),
                "name the file of a sound component_profile",
            );
            None
        }
    }
}

fn report_same(
    assembly: &Assembly<'_>,
    primary: &ComponentSpecification,
    secondary: &DeclaredSecondary,
    is_primary: bool,
) {
    let (message, help) = match is_primary {
        true => (
            format!(
                "the secondary of `{}` is that component itself",
                quoted(&primary.name)
            ),
            "it would fail as the primary does, and a reset does the same; name another profile",
        ),
        false => (
            format!(
                "`{}` is a secondary already",
                quoted(&secondary.reference.value)
            ),
            "it has failed when this one is reached; remove one of them",
        ),
    };
    assembly.report_at(Severity::Error, &secondary.reference.place, message, help);
}

/// The replacement under the primary's name, with the properties that the integrator gave it.
fn stand_in(
    assembly: &Assembly<'_>,
    component: usize,
    primary: &ComponentSpecification,
    secondary: &DeclaredSecondary,
    profile: &ComponentProfile,
) -> ComponentSpecification {
    let mut specification = ComponentSpecification {
        place: secondary.reference.place.clone(),
        ..primary.clone()
    };
    if let Some(site) = assembly.sites.get(component) {
        let (name, node) = (primary.name.clone(), &primary.node);
        let own = instances::component(profile, &site.subcomponent, name, node);
        specification = ComponentSpecification {
            place: specification.place,
            ..own
        };
    }
    specification
}

/// Every connected port of the primary is there in the secondary, just as it is.
fn check_ports(
    assembly: &Assembly<'_>,
    names: &Names<'_>,
    component: usize,
    secondary: &DeclaredSecondary,
    replacement: &ComponentSpecification,
) {
    let connections = &names.application.connections;
    let ends = connections
        .iter()
        .flat_map(|connection| [&connection.source, &connection.target]);
    let connected: Vec<&str> = ends
        .filter(|end| end.component == component)
        .map(|end| end.port.as_str())
        .collect();
    let primary = names.specification(component);
    for port in primary
        .ports
        .iter()
        .filter(|port| connected.contains(&port.name.as_str()))
    {
        let other = replacement
            .ports
            .iter()
            .find(|other| other.name == port.name);
        let found = match other {
            Some(other)
                if (other.kind, other.direction) == (port.kind, port.direction)
                    && other.data_type == port.data_type =>
            {
                continue;
            }
            Some(other) => format!(
                "there it is {} of `{}`",
                description(other),
                quoted(&other.data_type)
            ),
            None => "there it is missing".to_owned(),
        };
        assembly.report_at(
            Severity::Error,
            &secondary.reference.place,
            format!(
                "the secondary does not fit: port `{}` is {} of `{}`, {found}",
                quoted(&port.name),
                description(port),
                quoted(&port.data_type)
            ),
            "a secondary has all ports of its primary that are connected",
        );
    }
}
