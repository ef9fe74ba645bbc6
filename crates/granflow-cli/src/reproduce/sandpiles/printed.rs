//! The numbers that the paper prints.

/// An error and the order of convergence beside it; the first line of a table has none.
pub type Entry = (f64, Option<f64>);

const fn first(error: f64) -> Entry {
    (error, None)
}
const fn then(error: f64, order: f64) -> Entry {
    (error, Some(order))
}

/// Table 1 by scheme: the columns of u and of v.
pub const TABLE_1: [[[Entry; 5]; 2]; 3] = [
    [
        [
            first(0.0122),
            then(0.0069, 0.8122),
            then(0.0040, 0.7728),
            then(0.0023, 0.7941),
            then(0.0013, 0.8098),
        ],
        [
            first(0.0085),
            then(0.0052, 0.7100),
            then(0.0032, 0.7022),
            then(0.0019, 0.7899),
            then(0.0011, 0.7655),
        ],
    ],
    [
        [
            first(0.0058),
            then(0.0028, 1.0311),
            then(0.0014, 1.0422),
            then(0.0007, 1.0483),
            then(0.0003, 1.0656),
        ],
        [
            first(0.0049),
            then(0.0024, 1.0023),
            then(0.0012, 1.0237),
            then(0.0006, 1.0473),
            then(0.0003, 0.9933),
        ],
    ],
    [
        [
            first(0.0062),
            then(0.0030, 1.0674),
            then(0.0014, 1.0655),
            then(0.0007, 1.0633),
            then(0.0003, 1.0749),
        ],
        [
            first(0.0050),
            then(0.0025, 1.0395),
            then(0.0012, 1.0031),
            then(0.0006, 1.0423),
            then(0.0003, 1.0053),
        ],
    ],
];

/// Table 2 by scheme: the columns of u and of v.
pub const TABLE_2: [[[f64; 4]; 2]; 3] = [
    [[6.9388e-18, 1.3878e-17, 1.3878e-17, 6.9389e-18], [7.0546e-18, 8.7499e-17, 9.4632e-17, 1.2179e-15]],
    [[6.9389e-18, 6.9389e-18, 1.3878e-17, 6.9389e-18], [1e-4, 3.4875e-5, 8.7188e-6, 2.1797e-6]],
    [[6.9389e-18, 6.9389e-18, 1.3878e-17, 6.9389e-18], [5.3950e-17, 6.7966e-17, 7.2185e-17, 6.6996e-16]],
];
/// Half a unit of the last digit of v in Table 2's second-order lines.
pub const TABLE_2_DIGIT: [f64; 4] = [5e-5, 5e-10, 5e-11, 5e-11];

/// The table of the square by scheme, two columns, for 20, 40, 80 and 160 cells along a side.
pub const SQUARE: [[[Entry; 4]; 2]; 3] = [
    [
        [first(0.0662), then(0.0334, 0.9841), then(0.0167, 1.0037), then(0.0084, 0.9876)],
        [first(0.0031), then(0.0009, 1.7513), then(0.0002, 1.8799), then(6.4819e-5, 1.9368)],
    ],
    [
        [first(0.0599), then(0.0299, 0.9992), then(0.0150, 0.9994), then(0.0075, 0.9986)],
        [first(0.0038), then(0.0017, 1.1327), then(0.0008, 1.0709), then(0.0004, 1.0385)],
    ],
    [
        [first(0.0600), then(0.0300, 0.9995), then(0.0150, 0.9991), then(0.0075, 0.9984)],
        [first(0.0018), then(0.0005, 1.9026), then(0.0001, 1.9178), then(3.3913e-5, 1.9059)],
    ],
];
