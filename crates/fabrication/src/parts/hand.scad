// From here on everything follows from the parameters.

// Holes and widths; widths from the middle of a link, along its joints.
bore = (axle + print_clearance / 2) / 2;
pin_hole = (pin + print_clearance) / 2;
pin_circle = max(pin_from, bore + wall + pin_hole);
line_hole = line / 2 + print_clearance;
knot = 2.5 * line;
groove = line + print_clearance;
channel = groove + print_clearance;
pulley_half = groove + flange;
prong_from = pulley_half + print_clearance;
recess = prong_from + plate;
// Springs on the side of positive x, and on the other side.
sides = [ceil(springs / 2), floor(springs / 2)];
prong_to = recess + sides[0] * spring_room + print_clearance;
cheek_from = prong_to + print_clearance;
half_width = cheek_from + cheek;
holes = round(360 / hole_pitch);

// Legs of springs: beside the coil, clear of the axle, with walls between their holes; and the pocket for coil and legs.
function leg_hole(kind) = (spring_wire[kind] + print_clearance) / 2;
function leg_circle(kind) = max(
    spring_outer[kind] / 2 + print_clearance + spring_wire[kind] / 2,
    bore + wall + leg_hole(kind),
    (2 * leg_hole(kind) + wall) / (2 * sin(hole_pitch / 2)));
function pocket_radius(kind) = leg_circle(kind) + spring_wire[kind] / 2 + print_clearance;
function pocket_from(kind, side) = sides[side] > 0 ? prong_to - sides[side] * spring_length[kind] - print_clearance : prong_to;
lug = max([for (kind = [0:3]) leg_circle(kind) + leg_hole(kind)]) + 4 * wall;

// The radius of a disc whose straight sides keep outside of a circle.
function around(r) = r / cos(180 / $fn);
// The groove of a pulley whose line lies r from the axle, the hole that the line ends in, and the flanges.
function groove_bottom(r) = r - line / 2;
function line_end(kind) = max(radius[kind], pocket_radius(kind) + wall + knot);
function rim(r) = around(r + line_hole + wall);
function pinned_rim(kind) = around(max(line_end(kind) + line_hole, pin_circle + pin_hole) + wall);
// From a joint to where the whole width of a link begins, or its fork ends.
function setback(link) = max(rim(link), link) + 1.5 * print_clearance;
// Where the hole for a fixed leg is, in the frame of the open link.
function fixed_leg(kind, hole) = leg_circle(kind) * [sin(hole * hole_pitch), cos(hole * hole_pitch)];
// From a proximal joint to the end of its pocket, where the link stands tilted from straight down.
function reach(tilt) = max(link_radius[0], link_radius[2]) / cos(deg(tilt)) + 2.5 * print_clearance;
// What the open link leans on, in its frame.
function stop(link) = [[0, 0], [link - frame / 2, 0], [link - frame / 2, setback(link)], [frame, setback(link)]];
function deg(angle) = angle * 180 / PI;
function distal(kind) = kind % 2 == 1;

far = 1000;

// Shapes in the plane of y and z, and their extrusion along x.
module slice(from, to) rotate([90, 0, 90]) translate([0, 0, from]) linear_extrude(to - from) children();
module level(from, to) translate([0, 0, from]) linear_extrude(to - from) children();
module slices(from, to) {
    slice(from, to) children();
    slice(-to, -from) children();
}
module disc(r, at = [0, 0]) translate(at) rotate(180 / $fn) circle(r);
module hole(r, at) translate(at) rotate(180 / hole_fn) circle(r, $fn = hole_fn);
module slot(low, high, r) hull() {
    disc(r, [0, low]);
    disc(r, [0, high]);
}
module strip(low, high) translate([-far, low]) square([2 * far, high - low]);
module pins() for (side = [-1, 1]) disc(pin_hole, [side * pin_circle, 0]);
// On the side of positive x (0) or on the other one (1).
module sided(side, from, to) {
    if (side == 0) slice(from, to) children();
    else slice(-to, -from) children();
}
// What a distal line or its knot ends in: open where no wall would be left outside of it.
module line_ends(away, size, edge) {
    if (away + size > edge) slot(-far, -away, size);
    else disc(size, [0, -away]);
}
module fixed_legs(kind) for (hole = [0:holes - 1]) translate(fixed_leg(kind, hole)) hole(leg_hole(kind), [0, 0]);

module pulley(kind) {
    r = radius[kind];
    pinned = distal(kind);
    difference() {
        union() {
            slice(-groove, groove) disc(groove_bottom(r));
            slice(groove, pulley_half) disc(rim(r));
            slice(-pulley_half, -groove) disc(pinned ? pinned_rim(kind) : rim(r));
        }
        slice(-far, far) disc(bore);
        if (pinned) slice(-far, -groove) {
            pins();
            disc(line_hole, [0, -line_end(kind)]);
        }
    }
}

module link(kind) {
    r = link_radius[kind];
    length = link_length[kind];
    from = setback(r);
    to = distal(kind) ? length + r : length - setback(r);
    inner = min(r - frame, (to - from) / 2 - frame);
    difference() {
        union() {
            slice(-half_width, half_width) intersection() {
                slot(0, length, r);
                strip(from, to);
            }
            slices(prong_from, prong_to) intersection() {
                slot(0, length, r);
                strip(-far, to);
            }
            if (!distal(kind)) slices(cheek_from, half_width) intersection() {
                slot(0, length, r);
                strip(from, far);
            }
            if (!distal(kind)) slices(cheek_from, half_width) translate([0, length]) polygon(stop(link_radius[kind + 1]));
        }
        slice(-far, far) slot(from + frame + inner, to - frame - inner, inner);
        // Where the pads go.
        slice(-far, far) difference() {
            translate([-far, from]) square([far, to + (distal(kind) ? far : 0) - from]);
            slot(-far, length, r - pad);
        }
        slices(prong_from, prong_to) disc(bore);
        for (side = [0, 1]) if (sides[side] > 0) {
            sided(side, pocket_from(kind, side), prong_to) disc(pocket_radius(kind));
            sided(side, prong_from, pocket_from(kind, side)) hole(leg_hole(kind), [0, leg_circle(kind)]);
        }
        if (distal(kind)) {
            slice(-pocket_from(kind, 1), -prong_from) pins();
            slice(-recess, -prong_from) line_ends(line_end(kind), line_hole, r - wall);
            slice(-prong_to, -recess) line_ends(line_end(kind), knot, r - wall);
        } else {
            slice(-channel, channel) line_way(radius[kind], radius[kind + 1], length, r - pad, inner);
            slices(cheek_from, half_width) disc(bore, [0, length]);
            for (side = [0, 1]) if (sides[side] > 0)
                sided(side, cheek_from, half_width) translate([0, length]) fixed_legs(kind + 1);
        }
    }
}

// The line's way between two pulleys, along their tangent on the closing side; open where the wall outside gets thin, and to the
// window (half of whose width is w) where that inside does.
module line_way(a, b, length, r, w) {
    tilt = (a - b) / length;
    normal = [-sqrt(1 - tilt * tilt), tilt];
    close = [normal * (a - channel), normal * (b - channel) + [0, length]];
    thin = min(-close[0][0], -close[1][0]) - w < wall;
    inner = [for (corner = close) thin ? [max(corner[0], wall - w), corner[1]] : corner];
    outer = max(a, b) + channel + 2 * wall > r
        ? [[-r - channel, inner[0][1]], [-r - channel, inner[1][1]]]
        : [normal * (a + channel), normal * (b + channel) + [0, length]];
    polygon([inner[0], inner[1], outer[1], outer[0]]);
}

module palm() {
    difference() {
        union() {
            slice(-palm_half_size[0], palm_half_size[0])
                translate([-palm_half_size[1], 0]) square(2 * [palm_half_size[1], palm_half_size[2]]);
            for (digit = [0:2], side = [0, 1]) translate([base[digit][0], 0, 0])
                sided(side, cheek_from, lug_to(digit, side)) {
                    disc(lug, [base[digit][1], 0]);
                    polygon([for (corner = stop(link_radius[digit == 0 ? 0 : 2])) placed(digit, corner)]);
                }
        }
        for (digit = [0:2]) translate([base[digit][0], 0, 0]) digit_room(digit);
        for (hollow = hollows, side = [0, 1]) sided(side, hollow[0][0], hollow[0][1])
            translate([hollow[1][0], hollow[2][0]]) square([hollow[1][1] - hollow[1][0], hollow[2][1] - hollow[2][0]]);
    }
}

// From the frame of an open link to that of the palm, in y and z.
function placed(digit, p) = [
    base[digit][1] + sign(base[digit][1]) * (cos(deg(rest_angle)) * p[0] + sin(deg(rest_angle)) * p[1]),
    sin(deg(rest_angle)) * p[0] - cos(deg(rest_angle)) * p[1],
];

// Where a lug ends: at the side of the palm, where less than a wall would be left to that.
function rest(digit, side) = palm_half_size[0] - (side == 0 ? 1 : -1) * base[digit][0] - half_width;
function lug_to(digit, side) = half_width + (rest(digit, side) < wall ? rest(digit, side) : 0);

// What the palm leaves free for a digit.
module digit_room(digit) {
    y = base[digit][1];
    outward = sign(y);
    kind = digit == 0 ? 0 : 2;
    open = y + outward * reach(rest_angle);
    closed = y - outward * reach(closed_angle - rest_angle);
    slice(-cheek_from, cheek_from) translate([min(open, closed), -lug])
        square([abs(open - closed), lug + setback(link_radius[kind])]);
    way = channel + print_clearance;
    slice(-channel, channel) translate([y - outward * radius[kind] - way, 0])
        square([2 * way, 2 * palm_half_size[2] + way]);
    for (side = [0, 1]) sided(side, cheek_from, lug_to(digit, side)) {
        disc(bore, [y, 0]);
        // The link's x axis points along -x for digits that open along y.
        if (sides[outward > 0 ? 1 - side : side] > 0)
            for (index = [0:holes - 1]) hole(leg_hole(kind), placed(digit, fixed_leg(kind, index)));
    }
}

module digit(digit) {
    kind = digit == 0 ? 0 : 2;
    translate([base[digit][0], base[digit][1], 0])
        rotate([180 - deg(rest_angle), 0, base[digit][1] > 0 ? 180 : 0]) {
            jointed(kind);
            translate([0, 0, link_length[kind]]) jointed(kind + 1);
        }
}

module jointed(kind) {
    link(kind);
    color("gainsboro") pulley(kind);
}

if (part == "hand") {
    color("dimgray") palm();
    color("firebrick") digit(0);
    color("steelblue") for (index = [1, 2]) digit(index);
}
if (part == "palm") palm();
if (part == "thumb_proximal_link") link(0);
if (part == "thumb_distal_link") link(1);
if (part == "finger_proximal_link") link(2);
if (part == "finger_distal_link") link(3);
if (part == "thumb_proximal_pulley") pulley(0);
if (part == "thumb_distal_pulley") pulley(1);
if (part == "finger_proximal_pulley") pulley(2);
if (part == "finger_distal_pulley") pulley(3);
