//! Outlines: the outer border of each dark region that may be a marker.
//!
//! Follows borders by Moore's method (S. Suzuki, K. Abe: "Topological structural analysis of digitized binary images by
//! border following", 1985, for the termination criterion).

/// The eight neighbours clockwise from the right, y down.
const AROUND: [(i32, i32); 8] =
    [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Returns the outer borders of the 8-connected regions of `dark` with at least `shortest` steps, clockwise, in pixels.
/// Skips regions at the edge of the picture, which are incomplete.
pub fn outlines(
    dark: &[bool],
    width: usize,
    height: usize,
    shortest: usize,
) -> Vec<Vec<(i32, i32)>> {
    let mut found = Vec::new();
    let mut done = vec![false; dark.len()];
    let mut queue = Vec::new();
    for start in 0..dark.len() {
        if !dark[start] || done[start] {
            continue;
        }
        // Rows are scanned from the top, so this is the topmost, leftmost pixel of a region.
        let mut size = 0;
        let mut at_rim = false;
        done[start] = true;
        queue.push(start);
        while let Some(pixel) = queue.pop() {
            size += 1;
            let (x, y) = (pixel % width, pixel / width);
            if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
                at_rim = true;
            }
            for (dx, dy) in AROUND {
                let (nx, ny) = (x as i32 + dx, y as i32 + dy);
                if nx < 0 || ny < 0 || nx >= width as i32 || ny >= height as i32 {
                    continue;
                }
                let next = ny as usize * width + nx as usize;
                if dark[next] && !done[next] {
                    done[next] = true;
                    queue.push(next);
                }
            }
        }
        // A border of n steps has at least n / 2 pixels.
        if at_rim || size < shortest / 2 {
            continue;
        }
        let outline = follow(dark, width, height, start);
        if outline.len() >= shortest {
            found.push(outline);
        }
    }
    found
}

/// Returns the border of the region with the topmost, leftmost pixel `start`.
fn follow(dark: &[bool], width: usize, height: usize, start: usize) -> Vec<(i32, i32)> {
    let is_dark = |x: i32, y: i32| {
        x >= 0
            && y >= 0
            && (x as usize) < width
            && (y as usize) < height
            && dark[y as usize * width + x as usize]
    };
    let first = ((start % width) as i32, (start / width) as i32);
    let mut outline = vec![first];
    let (mut at, mut from) = (first, 4usize);
    let mut second = None;
    // A border passes a pixel at most four times.
    for _ in 0..4 * dark.len() {
        // Clockwise, starting after the pixel before.
        let step = (1..=8).map(|turn| (from + turn) % 8).find(|&direction| {
            let (dx, dy) = AROUND[direction];
            is_dark(at.0 + dx, at.1 + dy)
        });
        let Some(direction) = step else { return outline };
        let next = (at.0 + AROUND[direction].0, at.1 + AROUND[direction].1);
        if at == first {
            match second {
                None => second = Some(next),
                // Leaving the first pixel in the same direction again: the border is complete.
                Some(second) if second == next => {
                    outline.pop();
                    return outline;
                }
                Some(_) => {}
            }
        }
        outline.push(next);
        at = next;
        from = (direction + 4) % 8;
    }
    outline
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(rows: &[&str]) -> (Vec<bool>, usize, usize) {
        let dark = rows.iter().flat_map(|row| row.bytes().map(|b| b == b'#')).collect();
        (dark, rows[0].len(), rows.len())
    }

    #[test]
    fn borders_go_around_once() {
        let (dark, w, h) = picture(&[
            "..........",
            ".####..#..",
            ".#..#.....",
            ".#..#..##.",
            ".####..##.",
            "..........",
        ]);
        let found = outlines(&dark, w, h, 3);
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].len(), 12, "the ring, without its hole");
        assert_eq!(&found[0][..5], &[(1, 1), (2, 1), (3, 1), (4, 1), (4, 2)]);
        assert_eq!(found[1], [(7, 3), (8, 3), (8, 4), (7, 4)]);
    }

    #[test]
    fn outlines_cut_by_the_rim_are_left_out_and_thin_lines_end() {
        let (dark, w, h) = picture(&["##....", "##....", "...#..", "....#.", "......"]);
        assert_eq!(outlines(&dark, w, h, 2), [vec![(3, 2), (4, 3)]]);
        assert!(outlines(&[], 0, 0, 1).is_empty());
    }
}
