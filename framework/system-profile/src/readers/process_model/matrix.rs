//! Matrices as text.

use system_model::process_model::Matrix;

use crate::node::Node;
use crate::suggest::quoted;
use crate::value::Value;

/// A model of more states, inputs or outputs is none that a person wrote; its filter would cost
/// more time than the process leaves.
const SIZE_MAXIMUM: usize = 32;

/// Whether an element that may be left out is not there.
pub(super) fn unwritten(node: &Node<'_>, name: &'static str) -> bool {
    node.child(name).is_none()
}

/// The matrix in a mandatory child; an error if it has not so many rows and columns.
pub(super) fn read_matrix(
    node: &Node<'_>,
    name: &'static str,
    rows: Option<usize>,
    columns: Option<usize>,
) -> Option<Matrix> {
    let value = node.required_value(name)?;
    let matrix = parse(&value)?;
    let fits = |wanted: Option<usize>, found: usize| wanted.is_none_or(|wanted| wanted == found);
    if fits(rows, matrix.rows) && fits(columns, matrix.columns) {
        return Some(matrix);
    }
    let wanted =
        |count: Option<usize>| count.map_or("any number of".into(), |count| count.to_string());
    value.error(
        format!(
            "<{name}> has {} rows and {} columns",
            matrix.rows, matrix.columns
        ),
        Some(format!(
            "the other matrices ask for {} rows and {} columns",
            wanted(rows),
            wanted(columns)
        )),
    );
    None
}

/// The numbers of a mandatory child, in a row or a column.
pub(super) fn read_vector(
    node: &Node<'_>,
    name: &'static str,
    length: Option<usize>,
) -> Option<Vec<f64>> {
    let value = node.required_value(name)?;
    let matrix = parse(&value)?;
    let is_vector = matrix.rows == 1 || matrix.columns == 1;
    if is_vector && length.is_none_or(|length| length == matrix.elements.len()) {
        return Some(matrix.elements);
    }
    let wanted = length.map_or("one number for each state".into(), |length| {
        format!("{length} numbers, one for each state")
    });
    value.error(
        format!("<{name}> has {} numbers", matrix.elements.len()),
        Some(format!("write {wanted}")),
    );
    None
}

/// A covariance in a mandatory child: the matrix, or its diagonal as one row.
pub(super) fn read_covariance(
    node: &Node<'_>,
    name: &'static str,
    size: Option<usize>,
) -> Option<Matrix> {
    let value = node.required_value(name)?;
    let matrix = parse(&value)?;
    let matrix = match matrix.rows {
        1 => diagonal(&matrix.elements),
        _ => matrix,
    };
    if matrix.rows != matrix.columns || size.is_some_and(|size| size != matrix.rows) {
        let wanted = size.map_or("a square".into(), |size| {
            format!("{size} rows and {size} columns")
        });
        value.error(
            format!(
                "<{name}> has {} rows and {} columns",
                matrix.rows, matrix.columns
            ),
            Some(format!("write {wanted}, or the diagonal as one row")),
        );
        return None;
    }
    if let Some((row, column)) = asymmetry(&matrix) {
        value.error(
            format!(
                "<{name}> is no covariance: row {row}, column {column} is not row {column}, column {row}"
            ),
            Some("a covariance is symmetric; mend one of the two".into()),
        );
        return None;
    }
    if matrix
        .elements
        .iter()
        .step_by(matrix.rows + 1)
        .any(|variance| *variance < 0.0)
    {
        value.error(
            format!("<{name}> is no covariance: a variance is negative"),
            Some("the numbers of the diagonal are squares".into()),
        );
        return None;
    }
    Some(matrix)
}

fn diagonal(variances: &[f64]) -> Matrix {
    let size = variances.len();
    let mut matrix = Matrix::zeros(size, size);
    for (own, variance) in matrix.elements.iter_mut().step_by(size + 1).zip(variances) {
        *own = *variance;
    }
    matrix
}

/// Row and column, from 1, of an element that differs from its mirror image.
fn asymmetry(matrix: &Matrix) -> Option<(usize, usize)> {
    let element = |row: usize, column: usize| matrix.elements[row * matrix.columns + column];
    let pairs = (0..matrix.rows).flat_map(|row| (0..row).map(move |column| (row, column)));
    let mut odd = pairs.filter(|(row, column)| {
        let (lower, upper) = (element(*row, *column), element(*column, *row));
        // As exact as a person writes numbers down.
        (lower - upper).abs() > 1e-9 * lower.abs().max(upper.abs())
    });
    odd.next().map(|(row, column)| (row + 1, column + 1))
}

/// Rows separated by semicolons, of equal length; anything else is an error.
fn parse(value: &Value<'_>) -> Option<Matrix> {
    let separated = |character: char| character == ',' || character.is_whitespace();
    let rows = value.as_str().split(';').map(|row| {
        let words = row.split(separated).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>()
    });
    let mut rows: Vec<Vec<&str>> = rows.collect();
    // A semicolon behind the last row is harmless.
    if rows.len() > 1 && rows.last().is_some_and(Vec::is_empty) {
        rows.pop();
    }
    let columns = rows[0].len();
    if rows.len() > SIZE_MAXIMUM || columns > SIZE_MAXIMUM || columns == 0 {
        value.error(
            format!(
                "{} holds {} rows of {columns} numbers",
                value.owner(),
                rows.len()
            ),
            Some(format!("a model has 1 to {SIZE_MAXIMUM} rows and columns")),
        );
        return None;
    }
    if let Some(row) = rows.iter().position(|row| row.len() != columns) {
        value.error(
            format!(
                "row {} of {} has {} numbers, the first one {columns}",
                row + 1,
                value.owner(),
                rows[row].len()
            ),
            Some("write rows of equal length, with a semicolon between them".into()),
        );
        return None;
    }
    let words = rows.iter().flatten();
    let number = |word: &&str| {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            value.error(
                format!("`{}` in {} is no number", quoted(word), value.owner()),
                Some("write finite numbers such as 0.5, with blanks between them".into()),
            );
        }
        number
    };
    // All are looked at, so that all that are none are named.
    let numbers: Vec<Option<f64>> = words.map(number).collect();
    Some(Matrix {
        rows: rows.len(),
        columns,
        elements: numbers.into_iter().collect::<Option<_>>()?,
    })
}
