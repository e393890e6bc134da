// Bricks smaller than a pixel, which are hit as a whole: the twin of core/src/surface/small_bricks.rs.

// A brick is small from a weighted sum of its coordinates on.
struct SmallBricks {
    weights: vec3<i32>,
    least: i32,
}

const NO_SMALL_BRICKS: SmallBricks = SmallBricks(vec3<i32>(0), 0x7fffffff);

fn is_small(small: SmallBricks, brick: vec3<i32>) -> bool {
    let sum = small.weights * brick;
    return sum.x + sum.y + sum.z >= small.least;
}
