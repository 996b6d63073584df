"""Parts of small files of spectra, as instruments, databases and spreadsheets write them."""

from __future__ import annotations

import json

import numpy as np


def red(nm):
    """A smooth reflectance, dark in blue and bright in red."""
    return 0.05 + 0.55 / (1.0 + np.exp(-(np.asarray(nm, dtype=float) - 590.0) / 15.0))


NM = np.arange(380.0, 781.0, 5.0)
RED = red(NM)


PERCENT = 100.0 * RED
GREY = np.full(NM.size, 0.3)


def rows(*columns, sep=",", form="{:.5f}", x=NM, x_form="{:g}"):
    """Lines of numbers, wavelengths first."""
    numbers = zip(*columns, strict=True)
    return [
        sep.join([x_form.format(nm), *(form.format(v) for v in values)])
        for nm, values in zip(x, numbers, strict=True)
    ]


def text(*lines):
    """Lines as bytes."""
    flat = [one for line in lines for one in ([line] if isinstance(line, str) else line)]
    return ("\r\n".join(flat) + "\r\n").encode()


def comma(lines):
    """Lines with decimal commas."""
    return [line.replace(".", ",") for line in lines]


TENS = np.arange(400, 701, 10)


def in_rows(head, *names, scale=1.0, x=TENS, lead=(), sep=",", form="{:.4f}"):
    """A heading of wavelengths, and a line for each name; all red."""
    first, cell = head
    lines = [sep.join([first, *(one for one, _ in lead), *(cell.format(nm) for nm in x)])]
    for name in names:
        values = (form.format(scale * v) for v in red(x))
        lines.append(sep.join([name, *(one for _, one in lead), *values]))
    return lines


def jcamp(units, values, *, x="NANOMETERS", at=NM, form="xy", title="RED"):
    """A file of one block, as pairs or as ordinates at even steps."""
    head = [
        f"##TITLE= {title}",
        "##JCAMP-DX= 5.01 $$ a test",
        "##DATA TYPE= UV/VIS SPECTRUM",
        f"##XUNITS= {x}",
        f"##YUNITS= {units}",
        "##XFACTOR= 1.0",
        f"##YFACTOR= {1.0 if form == 'xy' else 0.0001}",
        f"##FIRSTX= {at[0]:g}",
        f"##LASTX= {at[-1]:g}",
        f"##NPOINTS= {at.size}",
    ]
    if form == "xy":
        data = [f"{nm:g}, {v:.6f}" for nm, v in zip(at, values, strict=True)]
        return text(head, "##XYPOINTS= (XY..XY)", data, "##END=")
    whole = np.round(np.asarray(values) * 1e4).astype(int)
    return text(head, "##XYDATA= (X++(Y..Y))", packed(at, whole, form), "##END=")


def packed(at, whole, form):
    """Ordinates in lines of ten as AFFN, PAC, SQZ or DIF with DUP."""

    def letter(number, plus, minus):
        digits = str(abs(number))
        return (minus[int(digits[0]) - 1] if number < 0 else plus[int(digits[0])]) + digits[1:]

    lines = []
    for k in range(0, len(whole), 10):
        some = whole[k : k + 10].tolist()
        if form == "AFFN":
            lines.append(" ".join([f"{at[k]:g}", *map(str, some)]))
        elif form == "PAC":
            lines.append(f"{at[k]:g}" + "".join(f"{v:+d}" for v in some))
        elif form == "SQZ":
            squeezed = "".join(letter(v, "@ABCDEFGHI", "abcdefghi") for v in some)
            lines.append(f"{at[k]:g}{squeezed}")
        else:
            # Each line but the last ends with the value that the next begins with, as a check.
            part = whole[k : k + 11].tolist()
            line = f"{at[k]:g}" + letter(part[0], "@ABCDEFGHI", "abcdefghi")
            steps, j = np.diff(part).tolist(), 0
            while j < len(steps):
                again = 1
                while j + again < len(steps) and steps[j + again] == steps[j]:
                    again += 1
                line += letter(steps[j], "%JKLMNOPQR", "jklmnopqr")
                line += "" if again == 1 else " STUVWXYZs"[again] if again < 10 else "S0"
                j += again
            lines.append(line)
    return lines


def qtx(scale=100.0):
    """Two samples of Datacolor's."""
    values = ",".join(f"{scale * v:.6f}" for v in RED)
    other = ",".join(f"{scale * v:.6f}" for v in GREY)
    return text(
        "[STANDARD_DATA 0]",
        "STD_NAME=Red",
        f"STD_REFLPOINTS={NM.size},",
        "STD_REFLINTERVAL=5,",
        "STD_REFLLOW=380,",
        "STD_VIEWING=SCI",
        f"STD_R={values}",
        "[BATCH_DATA 0 1]",
        "BAT_NAME=Grey",
        "BAT_REFLINTERVAL=5",
        "BAT_REFLLOW=380",
        f"BAT_R={other}",
    )


def cxf2(attribute=""):
    """A sample of GretagMacbeth's."""
    values = "".join(f'<Value Name="{nm:g}">{v:.5f}</Value>' for nm, v in zip(NM, RED, strict=True))
    return (
        '<?xml version="1.0"?><CXF xmlns="http://www.gretagmacbeth.com/CxF"><SampleSet><Sample>'
        f"<Name>Red</Name><SampleAttribute><Spectrum {attribute}>{values}</Spectrum>"
        "</SampleAttribute></Sample></SampleSet></CXF>"
    ).encode()


def tm27(quantity="reflectance"):
    """A spectrum as lighting engineers exchange it."""
    data = "".join(
        f'<SpectralData wavelength="{nm:g}">{v:.5f}</SpectralData>'
        for nm, v in zip(NM, RED, strict=True)
    )
    return (
        '<?xml version="1.0" encoding="utf-8"?><IESTM2714 xmlns="http://www.ies.org/iestm2714" '
        'version="1.0"><Header><Description>Red</Description></Header><SpectralDistribution>'
        f"<SpectralQuantity>{quantity}</SpectralQuantity>{data}</SpectralDistribution></IESTM2714>"
    ).encode()


def cgats(*, field="SPEC_{:g}", scale=1.0, more="", names=("Red",), quote='"', sep=" ", fit=True):
    """Samples as measuring programs write them."""
    fields = sep.join(["SAMPLE_ID", "SAMPLE_NAME", *(field.format(nm) for nm in NM)])
    lines = [
        sep.join([str(k), f"{quote}{name}{quote}", *(f"{scale * v:.6f}" for v in RED)])
        for k, name in enumerate(names, 1)
    ]
    return text(
        "CGATS.17",
        *([more] if more else []),
        f"NUMBER_OF_FIELDS {NM.size + 2}",
        "BEGIN_DATA_FORMAT",
        fields,
        "END_DATA_FORMAT",
        f"NUMBER_OF_SETS {len(names)}",
        "BEGIN_DATA",
        lines,
        "END_DATA",
    )


def igdb():
    """A pane of the International Glazing Database: 0.8 goes through, 0.075 comes back."""
    numbers = [f"{nm / 1000:.3f}\t0.8000\t0.0750\t0.0800" for nm in NM]
    return text(
        "{ Units, Wavelength Units } SI Microns",
        "{ Thickness } 3.048",
        "{ IR Transmittance } TIR=0",
        "{ Product Name: Clear }",
        "{ Type: Monolithic }",
        numbers,
    )


def igsdb_2(diffuse=False):
    """The same as version 2 of the database's JSON; 0.2 of it scattered, if asked for."""
    data = []
    for nm in NM:
        through = {"tf": "0.6" if diffuse else "0.8", "tb": "0.8", "rf": "0.075", "rb": 0.08}
        row = {"w": f"{nm / 1000:.3f}", "specular": through}
        if diffuse:
            row["diffuse"] = {"tf": 0.2, "rf": 0.0, "rb": None}
        data.append(row)
    blocks = [
        {
            "incidence_angle": 60,
            "wavelength_data": [{**row, "specular": {"tf": 0}} for row in data],
        },
        {"incidence_angle": 0, "wavelength_data": data},
    ]
    optical = {"optical_data": {"angle_blocks": blocks}}
    product = {"name": "Clear", "physical_properties": {"optical_properties": optical}}
    return json.dumps(product).encode()
