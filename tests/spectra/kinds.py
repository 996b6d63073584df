"""Small files of spectra as instruments, databases and spreadsheets write them, by their kind.

Each writes one reflectance, `RED`, or says in its name what else; measured by nobody.
"""

from __future__ import annotations

import numpy as np

from spectral_skylight.tests.spectra.kind_files import (
    GREY,
    NM,
    PERCENT,
    RED,
    TENS,
    cgats,
    comma,
    cxf2,
    in_rows,
    jcamp,
    qtx,
    red,
    rows,
    text,
    tm27,
)

KNOWN = {
    "spreadsheet, quoted names": ("a.csv", text('wl,"Red, matt"', rows(RED))),
    "spreadsheet, blank rows and columns": (
        "a.csv",
        text("wavelength,red,,", [f"{row},," for row in rows(RED)], ",,,", "", ",,,"),
    ),
    "spreadsheet, two headings": ("a.csv", text("Wavelength,Red", "nm,%", rows(PERCENT))),
    "spreadsheet, names over quantities": (
        "a.csv",
        text("Sample:,Red", "Wavelength [nm],Reflectance [%]", rows(PERCENT)),
    ),
    "spreadsheet, a title": ("a.csv", text("Paints of 2024,", "wavelength,Red", rows(RED))),
    "spreadsheet, cells in percent": (
        "a.csv",
        text("wavelength;Rot", comma(f"{row}%" for row in rows(PERCENT, sep=";"))),
    ),
    "spreadsheet, all quoted": (
        "a.csv",
        text(
            '"Wellenlänge (nm)","Rot"',
            comma(f'"{nm:g}"|"{v:.5f}"' for nm, v in zip(NM, RED, strict=True)),
        ).replace(b"|", b","),
    ),
    "spreadsheet, a heading of two lines": ("a.csv", text('"Wavelength\n(nm)",red', rows(RED))),
    "remarks beside it": (
        "a.csv",
        text(
            "nm,red,remark", [f"{row},{'ok' if k % 2 else ''}" for k, row in enumerate(rows(RED))]
        ),
    ),
    "UTF-16 without a mark": (
        "a.csv",
        text("nm;red", rows(RED, sep=";")).decode().encode("utf-16-le"),
    ),
    "UTF-16, big end first": (
        "a.csv",
        text("nm;red", rows(RED, sep=";")).decode().encode("utf-16-be"),
    ),
    "R, row names": (
        "a.csv",
        text('"","wl","red"', [f'"{k}",{row}' for k, row in enumerate(rows(RED), 1)]),
    ),
    "R, write.table": (
        "a.txt",
        text('"wl" "red"', [f'"{k}" {row}' for k, row in enumerate(rows(RED, sep=" "), 1)]),
    ),
    "pandas, an index of wavelengths": ("a.csv", text(",red", rows(RED))),
    "pandas, an index of rows": (
        "a.csv",
        text(",wavelength,red", [f"{k},{row}" for k, row in enumerate(rows(RED))]),
    ),
    "pixels before wavelengths": (
        "a.csv",
        text("Pixel,Wavelength,R", [f"{k},{row}" for k, row in enumerate(rows(RED))]),
    ),
    "R, rows are samples": (
        "a.csv",
        text(in_rows(('""', '"X{:g}"'), '"1"', '"2"')),
    ),
    "rows are samples, Konica Minolta": (
        "a.csv",
        text(
            in_rows(
                ("Data Name", "{:g}nm"),
                "Red",
                scale=100,
                lead=(("Date", "2024/01/01"), ("L*", "40.1")),
            )
        ),
    ),
    "rows are samples, percent in each heading": (
        "a.txt",
        text(in_rows(("Sample", "%R {:g} nm"), "Red", scale=100, sep="\t")),
    ),
    "rows are samples, decimal commas": (
        "a.csv",
        text(comma(in_rows(("Probe", "{:g}"), "Rot", sep=";"))),
    ),
    "rows are samples, from red to blue": (
        "a.csv",
        text(in_rows(("", "{:g}"), "Red", x=np.arange(700, 399, -10))),
    ),
    "one row with a heading": (
        "a.csv",
        text(in_rows(("Wavelength (nm)", "{:g}"), "Reflectance (%)", scale=100)),
    ),
    "renderer": ("a.spd", text("# a red paint", rows(RED, sep=" "))),
    "renderer, tabs": ("a.dat", text(rows(RED, sep="\t", x_form="{:.3f}"))),
    "many blanks": (
        "a.txt",
        text(
            "  Wavelength (nm)   Reflectance (%)", [f"   {r}" for r in rows(PERCENT, sep="      ")]
        ),
    ),
    "names in a comment": ("a.dat", text("# lambda[nm]  red", rows(RED, sep="  "))),
    "micrometres": ("a.csv", text("Wavelength (µm),red", rows(RED, x=NM / 1000, x_form="{:.4f}"))),
    "Ångström": ("a.csv", text("Wavelength [Å],red", rows(RED, x=NM * 10))),
    "wavenumbers": ("a.csv", text("Wavenumber (cm-1),red", rows(RED, x=1e7 / NM, x_form="{:.6f}"))),
    "Cary": (
        "a.csv",
        text(
            "Red,,Grey,,",
            "Wavelength (nm),%R,Wavelength (nm),%R,",
            [f"{a},{b}," for a, b in zip(rows(PERCENT), rows(100 * GREY, x=NM + 1), strict=True)][
                ::-1
            ],
            "",
            "Red",
            "Collection Time                   1/1/2024 10:00:00 AM",
            "Start (nm)                        780.0",
            "Y Mode                            %R",
        ),
    ),
    "OceanView": (
        "a.txt",
        text(
            "Data from red_001.txt Node",
            "",
            "Date: Tue Mar 18 08:44:17 EST 2014",
            "Integration Time (sec): 2.000000E-2",
            "XAxis mode: Wavelengths",
            "Number of Pixels in Spectrum: 81",
            ">>>>>Begin Spectral Data<<<<<",
            rows(PERCENT, sep="\t"),
            ">>>>>End Spectral Data<<<<<",
        ),
    ),
    "AvaSoft 7": (
        "a.ttt",
        text(
            "0804016U1- ",
            "Integration time: 100.00 ms",
            "Data measured with spectrometer name: 0804016U1" + "\0" * 9,
            "Wave   ;Reflectance",
            "[nm]   ;[% reflectance]",
            rows(PERCENT, sep=";"),
        ),
    ),
    "AvaSoft 8": (
        "a.txt",
        text(
            "Data from measurement red",
            "Wave\tSample\tDark\tReference\tReflectance",
            "[nm]\t[counts]\t[counts]\t[counts]\t[%]",
            comma(rows(9e4 * RED, 900 * GREY, 3e5 * GREY, PERCENT, sep="\t")),
        ),
    ),
    "ASD": (
        "a.txt",
        text(
            "",
            "Text conversion of header file C:\\spec\\a.asd",
            " -------------",
            "VNIR integration time : 34",
            "xmin = 350 xmax= 2500",
            "Wavelength\ta.asd",
            rows(RED, sep="\t", form="{:.6E}"),
        ),
    ),
    "Spectral Evolution": (
        "a.sed",
        text(
            "Version: 2.2",
            "Measurement: REFLECTANCE",
            "Columns [4]:",
            "Data:",
            "Wvl\tRad. (Ref.)\tRad. (Target)\tReflect. %",
            rows(3 + GREY, 3 * RED, PERCENT, sep="\t"),
        ),
    ),
    "Jasco": (
        "a.txt",
        text(
            "TITLE\tred",
            "ORIGIN\tJASCO",
            "XUNITS\tNANOMETERS",
            "YUNITS\t%R",
            f"NPOINTS\t{NM.size}",
            "XYDATA",
            rows(PERCENT, sep="\t")[::-1],
            "",
            "[Comments]",
            "Sample name\tred",
        ),
    ),
    "Shimadzu": (
        "a.txt",
        text('"red - RawData"', '"Wavelength nm."\t"R%"', rows(PERCENT, sep="\t")),
    ),
    "PerkinElmer": (
        "a.asc",
        text(
            "PE UV       SUBTECH     SPECTRUM    ASCII       PEDS        4.00",
            "-1",
            "nm",
            "%R",
            "#DATA",
            rows(PERCENT, sep="\t"),
        ),
    ),
    "SQZ": ("a.jdx", jcamp("REFLECTANCE", RED, form="SQZ")),
    "PAC": ("a.jdx", jcamp("REFLECTANCE", RED, form="PAC")),
    "AFFN": ("a.dx", jcamp("REFLECTANCE", RED, form="AFFN")),
    "DIF and DUP": ("a.jdx", jcamp("REFLECTANCE", RED, form="DIF")),
    "percent in JCAMP": ("a.jdx", jcamp("% REFLECTANCE", PERCENT)),
    "wavenumbers in JCAMP": ("a.jdx", jcamp("REFLECTANCE", RED, x="1/CM", at=1e7 / NM)),
    "absorbance in JCAMP": ("a.jdx", jcamp("ABSORBANCE", -np.log10(RED))),
    "absorbance": ("a.csv", text("Wavelength (nm),Abs", rows(-np.log10(RED)))),
    "log(1/R)": ("a.csv", text("nm,log(1/R)", rows(-np.log10(RED)))),
    "Kubelka-Munk": ("a.csv", text("nm,K/S", rows((1 - RED) ** 2 / (2 * RED), form="{:.7f}"))),
    "QTX": ("a.qtx", qtx()),
    "CxF2": ("a.cxf", cxf2()),
    "TM-27": ("a.spdx", tm27()),
    "CGATS, 380_NM": ("a.txt", cgats(field="{:g}_NM")),
    "CGATS, names with blanks": ("a.txt", cgats(names=("Dark red", "Red 2"), quote="", sep="\t")),
    "CGATS, names with blanks between blanks": ("a.txt", cgats(names=("Dark red 2",), quote="")),
    "CGATS, a norm of 30": ("a.sp", cgats(scale=30.0, more='SPECTRAL_NORM "30.0"')),
    "Spectra Vista": (
        "a.sig",
        text(
            "/*** Spectra Vista SIG Data ***/",
            "units= Radiance, Radiance",
            "data=",
            rows(117 + GREY, 117 * RED, PERCENT, sep="  "),
        ),
    ),
    "pairs without headings": (
        "a.csv",
        text([f"{a},{b}" for a, b in zip(rows(RED), rows(GREY), strict=True)]),
    ),
    "an id of the sample": ("a.csv", text("id,nm,red", [f"3,{row}" for row in rows(RED)])),
    "exponents of Fortran": (
        "a.txt",
        text("nm red", [r.replace("e", "D") for r in rows(RED, sep=" ", form="{:.5e}")]),
    ),
    "a remission": ("a.csv", text("nm;Remission / %", rows(PERCENT, sep=";"))),
    "rows are samples, with and without gloss": (
        "a.csv",
        text(
            "Name,"
            + ",".join(f"{nm}nm(SCI)" for nm in TENS)
            + ","
            + ",".join(f"{nm}nm(SCE)" for nm in TENS),
            "Red," + ",".join(f"{100 * v:.4f}" for v in [*red(TENS), *(0.9 * red(TENS))]),
        ),
    ),
    "names over dates over quantities": (
        "a.csv",
        text("Sample,Red", "Date,2024-01-01", "Wavelength,Reflectance", rows(RED)),
    ),
    "absorbance units": (
        "a.txt",
        text("Wave\tAbsorbance", "[nm]\t[A.U.]", rows(-np.log10(RED), sep="\t")),
    ),
    "absorbance by its file's name": (
        "a.txt",
        text("Data from x_Absorbance_001.txt Node", "", rows(-np.log10(RED), sep="\t")),
    ),
    "percent in French": (
        "a.csv",
        text("Longueur d'onde (nm);Rouge - Réflectance (%)", rows(PERCENT, sep=";")),
    ),
    "percent in Spanish": (
        "a.csv",
        text("Longitud de onda;Reflectancia en porcentaje", rows(PERCENT, sep=";")),
    ),
    "percent in Chinese": ("a.csv", text("波长(nm),反射率(%)", rows(PERCENT))),
    "percent in Japanese": ("a.csv", text("波長 [nm],反射率 [%]", rows(PERCENT))),
    "fraction in German": ("a.csv", text("Wellenlänge;Reflexionsgrad [1]", rows(RED, sep=";"))),
    "a fraction beside gloss": (
        "a.csv",
        text("wavelength_nm,reflectance,gloss60", rows(RED, 78 + GREY)),
    ),
    "a fraction beside its deviation": ("a.csv", text("nm,red,red_sd", rows(RED, 0.001 + 0 * RED))),
    "nothing in the ultraviolet": (
        "a.csv",
        text("nm,red", ["300,NA", "340,#N/A", "370,n.a."], rows(RED)),
    ),
    "nonsense in the infrared": (
        "a.csv",
        text("nm,red", rows(RED), ["800,-7", "900,over", "950,1e9"]),
    ),
}
"""Name → file name and bytes: `RED` is in each, to the digits written."""
