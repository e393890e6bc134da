//! Vectors and matrices, as far as rotating and mirroring need them.

pub type Vector = [f64; 3];

/// Rows of a matrix.
pub type Matrix = [Vector; 3];

pub fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

pub fn minus(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

/// Returns the vector scaled to length 1.
pub fn unit(v: Vector) -> Vector {
    v.map(|c| c / dot(v, v).sqrt())
}

pub fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|row| std::array::from_fn(|column| m[column][row]))
}

pub fn apply(m: &Matrix, v: Vector) -> Vector {
    m.map(|row| dot(row, v))
}

pub fn times(a: &Matrix, b: &Matrix) -> Matrix {
    let columns = transposed(b);
    std::array::from_fn(|row| std::array::from_fn(|column| dot(a[row], columns[column])))
}
