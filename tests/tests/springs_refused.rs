//! What springs on sides are refused with.

use steklov_tests::parse;

/// A block 0 ≤ x ≤ 2, 0 ≤ y ≤ 1 of E = 100, ν = 0.3 in plane stress, with conditions on its sides.
fn block(conditions: &str) -> String {
    format!(
        "body.corners = [[0,0],[2,0],[2,1],[0,1]]\nbody.sides = [\"floor\",\"right\",\"top\",\"left\"]\n\
         material = {{ young = 100.0, poisson = 0.3, plane = \"stress\" }}\n{conditions}"
    )
}

/// What springs cannot stand beside is refused, with its place and a remedy.
#[test]
fn what_springs_cannot_stand_beside() {
    let top = "sides.top.traction = [0, 1]\n";
    let cases = [
        ("sides.floor = { springs = \"1\", displacement = [0, \"free\"] }\n", "has springs and a displacement"),
        ("sides.floor = { springs = \"1\", contact = {} }\n", "has springs and is in contact"),
        ("sides.floor.springs = \"x-1\"\n", "the stiffness of springs of side \"floor\" is -1 at the point (0, 0)"),
        ("sides.floor.springs = \"1/x\"\n", "is inf at the point (0, 0)"),
        ("sides.floor.springs = [\"1\"]\n", "has 1 entry"),
        ("sides.floor.springs = true\n", "takes a stiffness"),
        ("sides.floor.springs = { normal = \"1\", shear = \"2\" }\n", "unknown key sides.floor.springs.shear"),
        ("sides.floor.springs = \"1e30\"\n", "as good as a held side"),
        ("sides.floor.spring = \"1\"\n", "springs"),
        ("sides.floor.springs = \"k\"\nrandom.k = { distribution = \"uniform\", low = 1.0, high = 2.0 }\n", "random"),
        (
            "sides.floor.springs = \"1\"\ngrid = { coarse = [2, 1], fine = [4, 4] }\nmethod.model = \"msfem\"\n",
            "on a grid",
        ),
        ("sides.hole.springs = \"1\"\nbody.holes = []\n", "has no side"),
    ];
    for (conditions, why) in cases {
        let error = parse(&block(&format!("{conditions}{top}")), &[]).err().unwrap_or_else(|| panic!("{conditions}"));
        let text = error.render();
        println!("{text}\n");
        assert!(text.contains(why) && text.contains("test.toml:"), "{conditions}: {text}");
    }
    let young = "random.E = { distribution = \"uniform\", low = 90.0, high = 110.0 }\n";
    let text = block(&format!("{young}sides.floor.springs = \"1\"\n{top}")).replace("100.0", "\"E\"");
    assert!(parse(&text, &[]).expect_err("a random modulus").render().contains("random Young's modulus"));
    let hole = "body = { circle = { centre = [0, 0], radius = 1 }, side = \"rim\" }\nexterior = { young = 1.0, poisson = 0.3 }\n\
                sides.rim = { springs = \"1\", pressure = 1 }\n";
    assert!(parse(hole, &[]).expect_err("a medium").render().contains("beside an unbounded medium"));
}
