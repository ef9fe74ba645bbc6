use super::Table;
use crate::scheme::Side;
use alloc::vec::Vec;
use std::prelude::v1::*;

#[test]
fn a_node_stands_for_the_cells_around_it_unless_it_ends_an_open_edge() {
    let line = Table::rectangle([4], [[true, false]]);
    assert_eq!([0, 1, 2, 3, 4].map(|i| line.weight([i])), [0.0, 1.0, 1.0, 1.0, 0.5]);
    let square = Table::rectangle([3, 2], [[true, false], [false, false]]);
    let row = |j| [0, 1, 2, 3].map(|i| square.weight([i, j]));
    assert_eq!([row(0), row(1), row(2)], [[0.0, 0.5, 0.5, 0.25], [0.0, 1.0, 1.0, 0.5], row(0)]);
    assert_eq!((square.count(), square.area([0.5, 2.0])), (6, 6.0));
}

#[test]
fn holes_are_enclosed_and_edges_know_which_way_they_face() {
    // A ring with a way out past one corner only, and a closed ring.
    let ring = |gap: bool| {
        let off = move |i: usize, j: usize| (i == 2 && j == 2) || (gap && (i, j) == (1, 1));
        Table::masked([5; 2], move |[i, j]| i > 0 && j > 0 && !off(i, j), |_| true)
    };
    assert!(ring(false).hole([2, 2]) && !ring(true).hole([2, 2]));
    let edges: Vec<_> = ring(false).edges().filter(|(edge, _)| edge.hole).map(|(edge, _)| edge).collect();
    assert_eq!(edges.len(), 4);
    let right = edges.iter().find(|edge| edge.axis == 0 && edge.faces == Side::Right).unwrap();
    assert_eq!((right.index, right.middle()), ([2, 2], [2.0, 2.5]));
    assert!(!ring(false).open_edges().iter().any(|edge| edge.hole));
}

#[test]
fn pieces_hang_together_by_faces() {
    let apart = Table::masked([4, 2], |[i, j]| (i < 2) == (j < 1), |edge| edge.middle()[1] != 0.0);
    let pieces = apart.pieces();
    assert_eq!(pieces.len(), 2);
    assert_eq!(
        pieces.iter().map(|piece| (piece.cells.len(), piece.open_edges)).collect::<Vec<_>>(),
        [(2, 2), (2, 0)]
    );
}

#[test]
fn cells_that_cannot_hold_sand_are_dropped() {
    // A spike two cells long and one wide on a square.
    let mask = |[i, j]: [usize; 2]| j < 4 || i == 1;
    let table = Table::masked([4, 6], mask, |_| false);
    assert_eq!((table.count(), table.dropped()), (16, 2));
    let walled = Table::masked([4, 6], mask, |edge| edge.axis == 0);
    assert_eq!((walled.count(), walled.dropped()), (18, 0));
}
