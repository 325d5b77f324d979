//! The fewest node hops of a solution, exactly, without enumerating its placements: components are
//! eliminated one after the other, the last first (dynamic programming over the links). A chain or
//! tree of n components on r robots takes n r² steps; links that join again take more.

use system_model::task::RobotIndex;

/// Entries of one table: a chain on a hundred robots needs a hundred, four links that cross each other
/// on ten robots ten thousand. Past a million it is no plan that an operator waits for.
const MAX_TABLE: usize = 1 << 20;

/// Links of a task cross each other so often that hops cannot be counted in bounded memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Entangled;

/// For every placement of the first components: the fewest hops that the others add to them.
#[derive(Debug)]
pub(crate) struct FewestHops<'a> {
    domains: &'a [Vec<RobotIndex>],
    /// By position: those before it that it is linked with, once for each link.
    linked_before: Vec<Vec<usize>>,
    /// By position: tables of later ones that depend on it and on none between.
    tables_at: Vec<Vec<usize>>,
    tables: Vec<Table>,
}

/// What one component and all that hang on it cost at least, given where those before it are.
#[derive(Debug)]
struct Table {
    /// Positions of those before it on which that depends, ascending.
    scope: Vec<usize>,
    /// By choices of the scope, the last one running fastest.
    fewest: Vec<u32>,
}

impl<'a> FewestHops<'a> {
    /// `domains` has the robots that each component may be on, ascending, none of them empty; `edges` are pairs
    /// of positions between which a hop counts.
    pub(crate) fn new(
        domains: &'a [Vec<RobotIndex>],
        edges: &[(usize, usize)],
    ) -> Result<Self, Entangled> {
        let mut linked_before = vec![Vec::new(); domains.len()];
        for (one, other) in edges {
            linked_before[*one.max(other)].push(*one.min(other));
        }
        let mut this = Self {
            domains,
            linked_before,
            tables_at: vec![Vec::new(); domains.len()],
            tables: (0..domains.len()).map(|_| Table::empty()).collect(),
        };
        for position in (0..domains.len()).rev() {
            this.eliminate(position)?;
        }
        Ok(this)
    }

    fn eliminate(&mut self, position: usize) -> Result<(), Entangled> {
        let later = self.tables_at[position].iter();
        let later = later.flat_map(|table| &self.tables[*table].scope);
        let mut scope: Vec<usize> = later
            .chain(&self.linked_before[position])
            .copied()
            .collect();
        scope.retain(|other| *other != position);
        scope.sort_unstable();
        scope.dedup();
        let sizes: Vec<usize> = scope.iter().map(|it| self.domains[*it].len()).collect();
        let entries = sizes.iter().try_fold(1_usize, |product, size| {
            product.checked_mul(*size).filter(|it| *it <= MAX_TABLE)
        });
        let entries = entries.ok_or(Entangled)?;
        let fewest = match scope[..] {
            [other] => self.on_one(position, other),
            _ => self.on_several(position, &scope, &sizes, entries),
        };
        if let Some(last) = scope.last() {
            self.tables_at[*last].push(position);
        }
        self.tables[position] = Table { scope, fewest };
        Ok(())
    }

    /// The table of a component that depends on one before it only by links and by nothing behind it,
    /// as in a chain or tree: either it is on the same robot, or on the best one and the links are hops.
    fn on_one(&self, position: usize, other: usize) -> Vec<u32> {
        let links = self.linked_before[position].len();
        let behind = self.tables_at[position].iter();
        let is_alone = { behind }.all(|table| self.tables[*table].scope == [position]);
        if !is_alone {
            let sizes = [self.domains[other].len()];
            return self.on_several(position, &[other], &sizes, sizes[0]);
        }
        let mut choices = vec![0; position + 1];
        let options = 0..self.domains[position].len();
        let alone = options.map(|choice| {
            choices[position] = choice;
            let behind = self.tables_at[position].iter();
            let behind = behind.map(|table| self.tables[*table].of(&choices, self.domains));
            behind.sum::<u32>()
        });
        let alone: Vec<u32> = alone.collect();
        let elsewhere = alone.iter().min().map_or(0, |least| least + links as u32);
        let here = |robot: &RobotIndex| {
            let found = self.domains[position].binary_search(robot);
            found.map_or(elsewhere, |choice| alone[choice].min(elsewhere))
        };
        self.domains[other].iter().map(here).collect()
    }

    fn on_several(
        &self,
        position: usize,
        scope: &[usize],
        sizes: &[usize],
        entries: usize,
    ) -> Vec<u32> {
        let mut choices = vec![0; position + 1];
        let mut fewest = Vec::with_capacity(entries);
        for entry in 0..entries {
            let mut rest = entry;
            for (other, size) in scope.iter().zip(sizes).rev() {
                choices[*other] = rest % size;
                rest /= size;
            }
            let options = 0..self.domains[position].len();
            let least = options.map(|choice| {
                choices[position] = choice;
                self.added(position, &choices)
            });
            fewest.push(least.min().unwrap_or(0));
        }
        fewest
    }

    /// Hops of the best placement of all components.
    pub(crate) fn of_all(&self) -> u32 {
        let roots = self.tables.iter().filter(|table| table.scope.is_empty());
        roots.map(|table| table.fewest[0]).sum()
    }

    /// The fewest hops in all once `choices` are made: those of one component less had `before`.
    pub(crate) fn after(&self, choices: &[usize], before: u32) -> u32 {
        let position = choices.len() - 1;
        before - self.tables[position].of(choices, self.domains) + self.added(position, choices)
    }

    /// The first of the placements with the fewest hops: as positions in the domains.
    pub(crate) fn first(&self) -> Vec<usize> {
        let mut choices = Vec::with_capacity(self.domains.len());
        for position in 0..self.domains.len() {
            let least = self.tables[position].of(&choices, self.domains);
            choices.push(0);
            while self.added(position, &choices) > least {
                choices[position] += 1;
            }
        }
        choices
    }

    /// What the choice at a position costs at least: its own hops to those before it, and all that is
    /// decided by it.
    fn added(&self, position: usize, choices: &[usize]) -> u32 {
        let robot = |position: usize| self.domains[position][choices[position]];
        let here = robot(position);
        let before = self.linked_before[position].iter();
        let own: u32 = before.map(|other| u32::from(robot(*other) != here)).sum();
        let later = self.tables_at[position].iter();
        let later = later.map(|table| self.tables[*table].of(choices, self.domains));
        own + later.sum::<u32>()
    }
}

impl Table {
    fn empty() -> Self {
        Self {
            scope: Vec::new(),
            fewest: vec![0],
        }
    }

    fn of(&self, choices: &[usize], domains: &[Vec<RobotIndex>]) -> u32 {
        let entry = self.scope.iter().fold(0, |entry, position| {
            entry * domains[*position].len() + choices[*position]
        });
        self.fewest[entry]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_forks_and_rings() {
        type Row = (
            Vec<Vec<usize>>,
            &'static [(usize, usize)],
            u32,
            &'static [usize],
        );
        let both = || vec![0, 1];
        let table: [Row; 5] = [
            // One end here, one there: the first of the best placements stays here long.
            (
                vec![vec![0], both(), both(), vec![1]],
                &[(0, 1), (1, 2), (2, 3)],
                1,
                &[0, 0, 0, 0],
            ),
            (
                vec![vec![1], both(), both(), vec![1]],
                &[(0, 1), (1, 2), (2, 3)],
                0,
                &[0, 1, 1, 0],
            ),
            // What is put in between stands behind those that it connects.
            (
                vec![vec![0], both(), vec![1]],
                &[(0, 2), (2, 1)],
                1,
                &[0, 1, 0],
            ),
            (
                vec![vec![0], vec![1], both()],
                &[(0, 2), (1, 2)],
                1,
                &[0, 0, 0],
            ),
            (
                vec![vec![0], both(), both(), vec![1]],
                &[(0, 1), (0, 2), (1, 3), (2, 3)],
                2,
                &[0; 4],
            ),
        ];
        for (domains, edges, fewest, first) in table {
            let hops = FewestHops::new(&domains, edges).expect("few links");
            assert_eq!(hops.of_all(), fewest, "{domains:?} {edges:?}");
            assert_eq!(hops.first(), first, "{domains:?} {edges:?}");
            let mut sum = fewest;
            for length in 1..=first.len() {
                sum = hops.after(&first[..length], sum);
                assert_eq!(sum, fewest);
            }
        }
    }

    #[test]
    fn links_without_bound_are_refused() {
        let domains = vec![(0..20).collect::<Vec<_>>(); 12];
        let pairs = (0..12).flat_map(|one| (0..one).map(move |other| (other, one)));
        let edges: Vec<_> = pairs.collect();
        assert_eq!(FewestHops::new(&domains, &edges).err(), Some(Entangled));
    }
}
