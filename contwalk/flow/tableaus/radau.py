"""Radau IIA collocation of orders 5 and 9.

Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd edition, IV.5 (the methods) and
IV.8 (the transformation that decouples the stages, and the embedded error estimate). The numbers were
computed with 60 digits from the definition: the nodes are the zeros of the (s-1)-th derivative of x^(s-1)
(x-1)^s, and the stages integrate polynomials of degree s-1 exactly. A test does that again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Mode:
    """An eigenvalue of A^-1 (one of each conjugate pair) with its vectors; left . right = 1."""

    eigenvalue: complex
    right: tuple[complex, ...]
    left: tuple[complex, ...]


@dataclass(frozen=True)
class Collocation:
    """A Radau IIA method.

    Attributes
    ----------
    nodes : tuple of float
        Where in a step the equation holds; the last is 1.
    matrix : tuple of tuples
        A, Z = h A f: the integrals of the Lagrange polynomials of the nodes.
    inverse : tuple of tuples
        Its inverse.
    real : Mode
        The real eigenvalue of A^-1; its inverse is the weight of f(t0, x0) in the embedded formula.
    pairs : tuple of Mode
        Its complex eigenvalues with positive imaginary part.
    error : tuple of float
        The embedded formula of order s minus the method, in terms of Z: error = h f(t0, x0) / real + error .
        Z.
    """

    nodes: Numbers
    matrix: tuple[Numbers, ...]
    inverse: tuple[Numbers, ...]
    real: Mode
    pairs: tuple[Mode, ...]
    error: Numbers

    @property
    def stages(self) -> int:
        """How many stages there are, s. The order is 2 s - 1."""
        return len(self.nodes)

    @property
    def linear(self) -> float:
        """Error of a step for h J = z, in units of the embedded estimate and of z^2 / |mu - z|^2.

        (The product of these over the pairs.) It is s / (s + 1), as the motion t^(s+1) shows.
        """
        return self.stages / (self.stages + 1)

    def packed(self) -> np.ndarray:
        """All numbers in one array of one axis, in the order in which `radau.parts.method` takes them apart.

        Its shape is (2 + s (2 s + 4) + pairs (2 + 4 s),) for s stages.
        """
        parts = [*self.nodes, *np.ravel(self.matrix), *np.ravel(self.inverse), *self.error]
        parts += [self.linear, self.real.eigenvalue.real, *np.real(self.real.right), *np.real(self.real.left)]
        for mode in self.pairs:
            parts += [mode.eigenvalue.real, mode.eigenvalue.imag]
            for vector in (mode.right, mode.left):
                parts += [*np.real(vector), *np.imag(vector)]
        return np.array(parts, dtype=float)


RADAU5 = Collocation(
    nodes=(0.1550510257216821901802716, 0.6449489742783178098197284, 1.0),
    matrix=(
        (0.1968154772236604258683861, -0.06553542585019838810852278, 0.02377097434822015242040823),
        (0.3944243147390872769974117, 0.2920734116652284630205027, -0.04154875212599793019818601),
        (0.3764030627004672750500754, 0.5124858261884216138388134, 0.1111111111111111111111111),
    ),
    inverse=(
        (3.224744871391589049098642, 1.167840084690405494924041, -0.2531972647421808261859424),
        (-3.567840084690405494924041, 0.775255128608410950901358, 1.053197264742180826185942),
        (5.531972647421808261859424, -7.531972647421808261859424, 5.0),
    ),
    real=Mode(
        complex(3.637834252744495732208, 0.0),
        (complex(0.09443876248897524148749, 0.0), complex(0.2502131229653333113765, 0.0), complex(1.0, 0.0)),
        (
            complex(4.178718591551904727346, 0.0),
            complex(0.3276828207610623870825, 0.0),
            complex(0.5233764454994495480399, 0.0),
        ),
    ),
    pairs=(
        Mode(
            complex(2.681082873627752133896, 3.050430199247410569426),
            (
                complex(-0.141255295020954208428, 0.03002919410514742449186),
                complex(0.204129352293799931996, -0.3829421127572619377954),
                complex(1.0, 0.0),
            ),
            (
                complex(-2.089359295775952363673, -0.2514363174728934379756),
                complex(-0.1638414103805311935413, 1.285963474927802714593),
                complex(0.23831177725027522598, -0.2980196024141124624844),
            ),
        ),
    ),
    error=(-2.762305454748599398349929, 0.3799355982527288778687474, -0.0916296098652257892492762),
)

RADAU9 = Collocation(
    nodes=(
        0.05710419611451768219312119,
        0.276843013638123827680046,
        0.5835904323689168200566977,
        0.8602401356562194478479129,
        1.0,
    ),
    matrix=(
        (
            0.07299886431790332430556853,
            -0.02673533110794557187769797,
            0.01867692976398435441224735,
            -0.01287910609330643985364695,
            5.042839233882015206650219e-3,
        ),
        (
            0.1537752314791824686681236,
            0.1462148678474935066496872,
            -0.0364445689051280895266502,
            0.02123306311930471942150766,
            -7.935579902728777532622279e-3,
        ),
        (
            0.1400630456848098715137557,
            0.2989671294912834793983035,
            0.1675850701352489634420614,
            -0.03396910168661774657192214,
            0.01094428874419225227449921,
        ),
        (
            0.1448943081095347575366006,
            0.2765000687601592275559344,
            0.325797922910421029984929,
            0.1287567532549097611582384,
            -0.01570891737880532838778946,
        ),
        (
            0.1437135607912259413234122,
            0.2813560151494620601921727,
            0.3118265229757412540818549,
            0.2231039010835707444025602,
            0.04,
        ),
    ),
    inverse=(
        (
            8.755923977938361667631661,
            2.891942615380117404357457,
            -0.8751863962002650264162826,
            0.3997052079399654826216567,
            -0.133706163849215835671702,
        ),
        (
            -7.16138072014538702739247,
            1.806077724083644363529878,
            2.363797176068608369422103,
            -0.8659007802831345191395346,
            0.2743380777751942021737668,
        ),
        (
            4.122165246243373781044035,
            -4.496017125813394719848837,
            0.8567652453971776050861934,
            2.518320949211064374937135,
            -0.6570627571343601062552304,
        ),
        (
            -3.87866321972401033363528,
            3.393151918064954168692954,
            -5.18834090640718687919712,
            0.5812330525808163637522676,
            2.809983655279712329602274,
        ),
        (
            8.412424223594288656407174,
            -6.970256116656660967032272,
            8.777114204150473239214027,
            -18.21928231108810092858893,
            13.0,
        ),
    ),
    real=Mode(
        complex(6.286704751729276645173, 0.0),
        (
            complex(0.01357686734494794324766, 0.0),
            complex(1.617900401719087476439e-3, 0.0),
            complex(0.0791578533474472076449, 0.0),
            complex(0.4122560826804614519787, 0.0),
            complex(1.0, 0.0),
        ),
        (
            complex(27.69769377568408840917, 0.0),
            complex(12.783337911304406015, 0.0),
            complex(3.208489386713429859798, 0.0),
            complex(-0.9514904122489162212717, 0.0),
            complex(0.7415504960259896033537, 0.0),
        ),
    ),
    pairs=(
        Mode(
            complex(5.70095329867178941917, 3.210265600308549888425),
            (
                complex(-0.01147851525522951470794, 0.01401985889287541028108),
                complex(-7.668830749180162885157e-3, -0.02470857842651852681253),
                complex(0.01939846399882895091122, -0.08180035370375117083639),
                complex(0.4076011712801990666217, -0.1996824278868025259365),
                complex(1.0, 0.0),
            ),
            (
                complex(-16.52094010675950000403, -4.30572198993764598885),
                complex(-8.688476739531783509727, 4.849995704764404115668),
                complex(-0.08606453162700278057576, 0.9573643198484371424257),
                complex(-0.04958488899127132129408, 1.209346003042470013213),
                complex(0.2656140579191533335925, -0.5237317439676687093472),
            ),
        ),
        Mode(
            complex(3.655694325463572258243, 6.543736899360077294021),
            (
                complex(-0.01024204781790882707009, -0.04767387729029572386318),
                complex(0.05017286451737105816299, 0.09433181918161143698066),
                complex(-0.2305395340434179467214, -0.1027030453801258997922),
                complex(0.3778939022488612495439, -0.4667441303324943592896),
                complex(1.0, 0.0),
            ),
            (
                complex(2.672093218917455799448, 1.874029903719902430026),
                complex(2.296807783879580502227, -1.992482868171942333626),
                complex(-1.518180161729712149323, -0.5222078208040093964711),
                complex(0.5253300951157294319299, 0.5920492840689742436155),
                complex(-0.1363893059321481352693, -0.2249588850783901844494),
            ),
        ),
    ),
    error=(
        -4.418997716796381722564232,
        0.5792348522566700544723169,
        -0.1992375609534680087358258,
        0.09416748369194548897544458,
        -0.03181316888549382409558303,
    ),
)
