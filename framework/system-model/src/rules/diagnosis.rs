//! How much a fault matters, and to whom.

/// What a fault of a component entails.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum ComponentSeverity {
    /// It is recorded.
    Ignore,
    /// The component is recovered in place. The default: most faults of software do not come back,
    /// and a fault that does climbs the ladder by its budget.
    #[default]
    Reset,
    /// The component is stopped, and what needs it.
    Stop,
    /// The robot is stopped at once.
    Emergency,
}

/// What it entails that a component cannot be recovered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum ApplicationSeverity {
    /// The application goes on without the component.
    Ignore,
    /// The application stops. The default: it was made with the component for a reason, and other
    /// applications may be safe without it.
    #[default]
    Local,
    /// Emergency stop of the system.
    Global,
}

/// What becomes of a dependent when too few of its providers are left.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub enum DependencySeverity {
    /// It is left running.
    Ignore,
    /// It is stopped, and may be started again. The default: whoever writes a dependency means that
    /// the one does not work without the other.
    #[default]
    Stop,
    /// It is destroyed.
    Destroy,
}

/// Something that can depend, or be depended on.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Entity {
    /// A component, by its index in the application.
    Component(usize),
    /// An executor, by the index of the first component that it runs.
    Executor(usize),
    /// An application, by name.
    Application(String),
}

/// One of the providers of a dependency.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Provider {
    /// What is needed.
    pub entity: Entity,
    /// Its name as written.
    pub name: String,
}

/// `dependency`: the dependent works only while enough of its providers do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DependencyRule {
    /// Who depends.
    pub dependent: Provider,
    /// On whom.
    pub providers: Vec<Provider>,
    /// So many of the providers must be healthy, at least 1; where nothing is said, all of them.
    pub need: usize,
    /// What becomes of the dependent otherwise.
    pub severity: DependencySeverity,
}
