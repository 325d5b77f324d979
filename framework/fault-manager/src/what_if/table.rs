//! Every fault of every component, with what would come of it.

use super::supposition::data_ports;
use super::{Answer, Assumptions, Inapplicable, Recoveries, SupposedFault, Supposition, answer};
use crate::system::Scope;

/// Every fault of every component.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// One for each component, in the order of applications.
    pub rows: Vec<Row>,
}

/// One component.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Index of its application.
    pub application: usize,
    /// Index in it.
    pub component: usize,
    /// Instance name.
    pub name: String,
    /// In the order of [`SupposedFault::ALL`]; a fault of data has a cell for each data port, or one
    /// that says that there is none.
    pub cells: Vec<Cell>,
    /// What would come of it if the component could not be brought back: a segmentation fault of
    /// which every recovery fails.
    pub loss: Result<Answer, Inapplicable>,
}

/// One fault of one component.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// What is supposed.
    pub supposition: Supposition,
    /// What would come of it, or why there cannot be such a fault.
    pub answer: Result<Answer, Inapplicable>,
}

impl Table {
    /// Answers every question; `done` is told of each row, that is complete then.
    pub fn new(scopes: &[Scope], assumptions: &Assumptions, done: &mut dyn FnMut(&Row)) -> Self {
        let mut rows = Vec::new();
        for (application, scope) in scopes.iter().enumerate() {
            for (component, specification) in scope.specification.components.iter().enumerate() {
                let cell = |port: Option<String>, fault: SupposedFault| {
                    let supposition = Supposition {
                        application,
                        component,
                        port,
                        fault,
                    };
                    Cell {
                        answer: answer(scopes, &supposition, assumptions),
                        supposition,
                    }
                };
                let cells = SupposedFault::ALL.into_iter().flat_map(|fault| {
                    let mut ports: Vec<Option<String>> = match fault {
                        SupposedFault::Port(_) => {
                            data_ports(specification).cloned().map(Some).collect()
                        }
                        _ => Vec::new(),
                    };
                    if ports.is_empty() {
                        ports.push(None);
                    }
                    ports.into_iter().map(move |port| (port, fault))
                });
                let row = Row {
                    application,
                    component,
                    name: specification.name.clone(),
                    cells: cells.map(|(port, fault)| cell(port, fault)).collect(),
                    loss: loss(scopes, application, component, assumptions),
                };
                done(&row);
                rows.push(row);
            }
        }
        Self { rows }
    }
}

fn loss(
    scopes: &[Scope],
    application: usize,
    component: usize,
    assumptions: &Assumptions,
) -> Result<Answer, Inapplicable> {
    let supposition = Supposition {
        application,
        component,
        port: None,
        fault: SupposedFault::Callback(system_model::injection::Misbehaviour::Segfault),
    };
    let assumptions = Assumptions {
        recoveries: Recoveries::Fail,
        ..assumptions.clone()
    };
    answer(scopes, &supposition, &assumptions)
}
