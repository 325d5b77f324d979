//! The table as a page that needs nothing but itself.

use fault_manager::Scope;
use fault_manager::what_if::Table;

/// The page.
pub fn html(_scopes: &[Scope], _table: &Table) -> String {
    String::new()
}
