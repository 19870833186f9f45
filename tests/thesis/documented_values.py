"""Values that runs/README.md tells of what each run file finds, as it writes them.

Each is a label and the parameters of a point, found where they agree to one unit of the last digit. Files not
named tell no values, or have them in a table of margins.
"""

from __future__ import annotations

from collections.abc import Mapping

Told = tuple[str, Mapping[str, str]]


def _each(label: str, parameter: str, *values: str) -> list[Told]:
    return [(label, {parameter: value}) for value in values]


def _pairs(label: str, names: tuple[str, str], *pairs: tuple[str, str]) -> list[Told]:
    return [(label, dict(zip(names, pair, strict=True))) for pair in pairs]


DOCUMENTED: dict[str, list[Told]] = {
    "autobalancer_omega": [
        *_each("HB", "omega", "1.02721"),
        *_each("LP", "omega", "0.55917", "1.73629"),
    ],
    "autobalancer_omega_light_damping": [
        *_each("HB", "omega", "1.17311", "1.16004"),
        *_each("LP", "omega", "0.90483", "1.07299"),
    ],
    "autobalancer_load": [
        *_each("BP", "m", "0.02"),
        *_each("LP", "m", "0.0028205"),
        *_each("UZ", "m", "0.014139"),
    ],
    "autobalancer_load_unstable": [
        *_each("HB", "m", "0.0113378", "0.0164525"),
        *_each("BP", "m", "0.02"),
        *_each("LP", "m", "0.0095802"),
        *_each("UZ", "m", "0.014127"),
    ],
    "autobalancer_damping_chart": _each("HB", "c", "2.9620248"),
    "autobalancer_load_drag_chart": [
        *_each("HB", "m", "0.0131202", "0.0150859"),
        *_each("GH", "m", "0.0179657", "0.0189528"),
    ],
    "autobalancer_border_chart": _each("HB", "c", "1.9717771"),
    "autobalancer_drag": _each("HB", "delta", "0.0060721"),
    "autobalancer_cascade": [
        *_each("HB", "delta", "0.0060721"),
        *_each("PD", "delta", "0.0032676", "0.0030588", "0.0030299", "0.0030252"),
    ],
    "autobalancer_three_systems": _each("UZ", "m", "0.0141325", "0.0141390", "0.0141361"),
    "autobalancer_anisotropic": _each("NS", "omega", "0.762190"),
    "autobalancer_anisotropic_fig19": [
        *_each("NS", "omega", "1.014112", "6.997815", "12.618218"),
        *_each("UZ", "omega", "3.44308"),
    ],
    "autobalancer_anisotropic_fig20": _each("UZ", "m", "0.0141398"),
    "autobalancer_anisotropic_fig21": _each("UZ", "m", "0.0141409"),
    "three_masses_load": [
        *_each("LP", "m", "0.0041833", "0.0013983", "0.0270950"),
        *_each("BP", "m", "0.03", "0.01"),
    ],
    "three_masses_stability_chart": _pairs(
        "GH",
        ("angle3", "m"),
        ("1.93388", "0.0164322"),
        ("1.99423", "0.0168670"),
        ("2.33235", "0.0214354"),
        ("2.33683", "0.0218606"),
    ),
    "straight_walker_point_masses": _each(
        "PD", "gamma", "0.0150884", "0.0176694", "0.0181601", "0.0182648", "0.0182873"
    ),
    "straight_walker_feet": _each("LP", "r", "0.7481820"),
    "planar_slope": [
        *_each("LP", "alpha", "0.0368974"),
        *_each("PD", "alpha", "0.0982189", "0.1089903", "0.1114144", "0.1119200"),
        *_each("GR", "alpha", "0.0573319", "0.0960800", "0.0377858", "0.0415342"),
        *_each("AZ", "alpha", "0.0528541", "0.0385619", "0.2775819"),
    ],
    "planar_feet": _each("UZ", "path", "0.6262023"),
    "planar_negative_feet": [
        *_each("PD", "rf", "-0.0420138"),
        *_each("AZ", "rf", "-0.0656424"),
    ],
    "planar_foot_radius_curves": [
        *_pairs("LPPD", ("alpha", "rf"), ("0.0382021", "0.1036605")),
        *_pairs(
            "GRPD",
            ("alpha", "rf"),
            ("0.0404756", "0.0861230"),
            ("0.0697428", "0.0382040"),
            ("0.0971018", "0.1141500"),
        ),
        *_each("GPD", "rf", "0.0923412"),
    ],
    "planar_inertia_curves": [
        *_pairs("GRLP", ("alpha", "i2"), ("0.0358820", "0.0126759")),
        *_pairs("LPPD", ("alpha", "i2"), ("0.0354263", "0.0176520")),
        *_pairs(
            "GRPD",
            ("alpha", "i2"),
            ("0.0355075", "0.0174992"),
            ("0.0531353", "0.0176218"),
            ("0.0956766", "0.0013566"),
        ),
        *_pairs("GRGR", ("alpha", "i2"), ("0.0395613", "0.0233948")),
    ],
    "walker3d_overlap_inclination": [
        *_each("LP", "alpha", "0.1123335", "0.0641916"),
        *_each("NS", "alpha", "0.0686760", "0.0704820"),
        *_each("BP", "alpha", "0.0704533"),
        *_each("GR", "alpha", "0.0938827", "0.0890046", "0.0682401", "0.0664664", "0.0648447"),
        *_each("GR", "alpha", "0.0664546", "0.0707170", "0.0704979"),
    ],
    "walker3d_overlap_ground_stiffness": [
        *_each("BP", "k_y", "5869.371"),
        *_each("GR", "k_y", "5889.289"),
    ],
    "walker3d_knee_release": _each("OC", "c_knee", "13.0202160"),
    "walker3d_overlap_planar": [
        *_each("NS", "path", "0.1353498"),
        *_each("BP", "path", "0.3824688"),
    ],
    "walker3d_figure9": [
        *_each("LP", "alpha", "0.1120038", "0.0675183"),
        *_each("NS", "alpha", "0.0741025", "0.0712720"),
        *_each("GR", "alpha", "0.0941206", "0.0891646", "0.0686373", "0.0699931"),
    ],
    "walker3d_no_overlap_inclination": [
        *_each("NS", "alpha", "0.0776041", "0.0822754", "0.0744369"),
        *_each("BP", "alpha", "0.0853659", "0.0896011"),
        *_each("LP", "alpha", "0.0853454", "0.0896018"),
    ],
    "walker3d_no_overlap_ground_stiffness": [
        *_each("NS", "k_y", "12793.26", "15156.42"),
        *_each("GR", "k_y", "15302.169"),
    ],
    "walker3d_no_overlap_ground_damping": [
        *_each("NS", "c_y", "733.764"),
        *_each("BP", "c_y", "971.428"),
        *_each("LP", "c_y", "965.283"),
    ],
    "walker3d_ground_region": [
        *_pairs("R2", ("k_y", "c_y"), ("11184.99", "1142.37")),
        *_pairs("R3", ("k_y", "c_y"), ("13565.02", "676.28")),
        *_pairs("GRNS", ("k_y", "c_y"), ("15326.44", "798.83")),
        *_pairs("GR", ("k_y", "c_y"), ("15328.57", "801.33")),
    ],
    "walker3d_oblique_ground_stiffness": [
        *_each("LP", "k_y", "11552.147"),
        *_each("BP", "k_y", "11598.363"),
        *_each("PD", "k_y", "14652.781"),
        *_each("GR", "k_y", "14990.653"),
    ],
    "walker3d_knee_region": [
        *_pairs("GRNS", ("k_knee", "c_knee"), ("115.880183", "0.686654"), ("86.126224", "0.694839")),
        *_pairs("PDNS", ("k_knee", "c_knee"), ("93.630175", "1.142556"), ("76.584290", "1.151499")),
    ],
    "walker3d_no_overlap_knee_stiffness": _each("NS", "k_knee", "102.960"),
    "walker3d_no_overlap_knee_damping": [
        *_each("NS", "c_knee", "0.777636", "1.068293"),
        *_each("BP", "c_knee", "1.271467", "1.372645"),
    ],
    "walker3d_stiffer_ground_knee_damping": [
        *_each("GR", "c_knee", "0.680969"),
        *_each("NS", "c_knee", "1.100965"),
    ],
    "walker3d_stiffer_ground_knee_stiffness": [
        *_each("NS", "k_knee", "69.383459", "107.602691"),
        *_each("OC", "k_knee", "85.199289"),
    ],
    "walker3d_stiffer_ground_soft_knee_damping": [
        *_each("NS", "c_knee", "0.814767"),
        *_each("BP", "c_knee", "1.115896"),
    ],
    "walker3d_stiffer_ground_inclination": [
        *_each("NS", "alpha", "0.0753194", "0.0823320"),
        *_each("BP", "alpha", "0.0818574"),
        *_each("LP", "alpha", "0.0817609"),
    ],
    "walker3d_homotopy_beyond": _each("NS", "path", "0.3390444"),
    "walker3d_homotopy": [
        *_each("NS", "path", "0.2065930", "0.9965817"),
        *_each("BP", "path", "0.2486609", "0.3004937"),
    ],
}

# Means and standard errors of samples, in revolutions, as the report of the command writes them.
MEANS = {
    "autobalancer_monte_carlo_system1": "12.035 ± 0.076",
    "autobalancer_monte_carlo_system2": "9.387 ± 0.054",
    "autobalancer_monte_carlo_system3": "7.311 ± 0.022",
}
