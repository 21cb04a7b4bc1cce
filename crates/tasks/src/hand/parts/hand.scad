// From here on everything follows from the parameters.

// Holes and widths; widths from the middle of a link, along its joints.
bore = (shaft_diameter + clearance / 2) / 2;
leg_hole = (leg_diameter + clearance) / 2;
leg_circle = spring_diameter / 2 - 0.8 * leg_diameter;
line_hole = line_diameter / 2 + clearance;
knot = 2.5 * line_diameter;
groove = line_diameter + clearance;
channel = groove + clearance;
pulley_half = groove + flange;
prong_from = pulley_half + clearance;
pocket_from = prong_from + prong;
prong_to = pocket_from + spring_length + clearance;
cheek_from = prong_to + clearance;
half_width = cheek_from + cheek;
pocket_radius = spring_diameter / 2 + 2.5 * clearance;
lug = leg_circle + leg_hole + 4 * wall;

// The groove of a pulley whose line lies r from the shaft, the hole that the line ends in, and the flanges.
function groove_bottom(r) = r - line_diameter / 2;
function line_end(r) = max(r, bore + wall + line_hole);
function rim(r) = line_end(r) + line_hole + 2 * clearance;
// From a joint to where the whole width of a link begins, or its fork ends.
function setback(link) = max(rim(link), link) + 1.5 * clearance;
// Where the leg that does not turn is, in the frame of the open link.
function fixed_leg(p) = leg_circle * [sin(deg(p)), cos(deg(p))];
// From a proximal joint to the end of its pocket, where the link stands tilted from straight down.
function reach(tilt) = max(link_radius[0], link_radius[2]) / cos(deg(tilt)) + 2.5 * clearance;
// What the open link leans on, in its frame.
function stop(link) = [[0, 0], [link - frame / 2, 0], [link - frame / 2, setback(link)], [frame, setback(link)]];
function deg(angle) = angle * 180 / PI;
function distal(kind) = kind % 2 == 1;

far = 1000;

// Shapes in the plane of y and z, and their extrusion along x.
module slice(from, to) rotate([90, 0, 90]) translate([0, 0, from]) linear_extrude(to - from) children();
module slices(from, to) {
    slice(from, to) children();
    slice(-to, -from) children();
}
module disc(r, at = [0, 0]) translate(at) rotate(180 / $fn) circle(r);
module slot(low, high, r) hull() {
    disc(r, [0, low]);
    disc(r, [0, high]);
}
module strip(low, high) translate([-far, low]) square([2 * far, high - low]);
module pins(r) for (side = [-1, 1]) disc(r, [side * leg_circle, 0]);

module pulley(kind) {
    r = radius[kind];
    pinned = distal(kind);
    difference() {
        union() {
            slice(-groove, groove) disc(groove_bottom(r));
            slice(groove, pulley_half) disc(rim(r));
            slice(-pulley_half, -groove) disc(pinned ? max(rim(r), leg_circle + leg_hole + wall) : rim(r));
        }
        slice(-far, far) disc(bore);
        if (pinned) slice(-far, -groove) {
            pins(leg_hole);
            disc(line_hole, [0, line_end(r)]);
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
        slices(prong_from, prong_to) disc(bore);
        slice(pocket_from, prong_to) disc(pocket_radius);
        slice(prong_from, pocket_from) disc(leg_hole, [0, leg_circle]);
        if (distal(kind)) {
            slice(-prong_to, -prong_from) pins(leg_hole);
            slice(-pocket_from, -prong_from) disc(line_hole, [0, line_end(radius[kind])]);
            slice(-prong_to, -pocket_from) disc(knot, [0, line_end(radius[kind])]);
        } else {
            slice(-channel, channel) line_way(radius[kind], radius[kind + 1], length, r);
            slices(cheek_from, half_width) disc(bore, [0, length]);
            slice(cheek_from, half_width) disc(leg_hole, [0, length] + fixed_leg(preload[kind + 1]));
        }
    }
}

// The line's way between two pulleys, along their tangent on the closing side; open where the wall outside gets thin.
module line_way(a, b, length, r) {
    tilt = (a - b) / length;
    normal = [-sqrt(1 - tilt * tilt), tilt];
    inner = [normal * (a - channel), normal * (b - channel) + [0, length]];
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
            for (digit = [0:2]) translate([base[digit][0], 0, 0]) slices(cheek_from, half_width) {
                disc(lug, [base[digit][1], 0]);
                polygon([for (corner = stop(link_radius[digit == 0 ? 0 : 2])) placed(digit, corner)]);
            }
        }
        for (digit = [0:2]) translate([base[digit][0], 0, 0]) digit_room(digit);
    }
}

// From the frame of an open link to that of the palm, in y and z.
function placed(digit, p) = [
    base[digit][1] + sign(base[digit][1]) * (cos(deg(rest_angle)) * p[0] + sin(deg(rest_angle)) * p[1]),
    sin(deg(rest_angle)) * p[0] - cos(deg(rest_angle)) * p[1],
];

// What the palm leaves free for a digit.
module digit_room(digit) {
    y = base[digit][1];
    outward = sign(y);
    kind = digit == 0 ? 0 : 2;
    open = y + outward * reach(rest_angle);
    closed = y - outward * reach(closed_angle - rest_angle);
    slice(-cheek_from, cheek_from) translate([min(open, closed), -lug])
        square([abs(open - closed), lug + setback(link_radius[kind])]);
    slice(-channel, channel) translate([y - outward * radius[kind] - channel, 0])
        square([2 * channel, 2 * palm_half_size[2] + channel]);
    slices(cheek_from, half_width) disc(bore, [y, 0]);
    // The link's x axis points along -x for digits that open along y.
    mirror([outward > 0 ? 1 : 0, 0, 0]) slice(cheek_from, half_width)
        disc(leg_hole, placed(digit, fixed_leg(preload[kind])));
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
