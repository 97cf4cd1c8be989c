"""Makes the glass catalogue from the files of the refractiveindex.info database (public domain, CC0).

    python make_catalogue.py DATABASE

DATABASE is the folder with `main`, `specs`, `organic` and `other`; the Python package `refractiveindex` (1.3.1) includes it.
Writes MAKER.agf for each maker of glass and `materials.yml` for everything else. Needs PyYAML. Texts are reduced to the references.
"""

import html
import math
import re
import sys
from pathlib import Path

import yaml

HERE = Path(__file__).parent

# Maker, title, folders, and which names to take.
MAKERS = [
    ("schott", "Schott", ["optical", "obsolete"], r".*"),
    ("ohara", "Ohara", ["optical"], r"[SL]-.*"),
    # without the variants MC- and MP- of the glasses for moulding, M-
    ("hoya", "Hoya", ["optical"], r"(?!M[CP]-).*"),
    # names with -25 are the same glasses after faster cooling
    ("cdgm", "CDGM", ["optical"], r".*(?<!-25)"),
]

# Tables are cut to this range in µm: the optics here does not apply to X-rays and radio waves.
WINDOW_UM = (0.1, 30.0)

# Name, aliases, file.
MATERIALS = [
    ("fused silica", "SiO2, silica, quartz glass", "main/SiO2/nk/Malitson.yml"),
    ("quartz o", "quartz, crystal quartz o", "main/SiO2/nk/Ghosh-o.yml"),
    ("quartz e", "crystal quartz e", "main/SiO2/nk/Ghosh-e.yml"),
    ("sapphire o", "sapphire, Al2O3", "main/Al2O3/nk/Malitson-o.yml"),
    ("sapphire e", "", "main/Al2O3/nk/Malitson-e.yml"),
    ("CaF2", "calcium fluoride, fluorite", "main/CaF2/nk/Malitson.yml"),
    ("MgF2 o", "MgF2, magnesium fluoride", "main/MgF2/nk/Dodge-o.yml"),
    ("MgF2 e", "", "main/MgF2/nk/Dodge-e.yml"),
    ("BaF2", "barium fluoride", "main/BaF2/nk/Malitson.yml"),
    ("LiF", "lithium fluoride", "main/LiF/nk/Li.yml"),
    ("NaF", "sodium fluoride", "main/NaF/nk/Li.yml"),
    ("SrF2", "strontium fluoride", "main/SrF2/nk/Feldman.yml"),
    ("NaCl", "sodium chloride, rock salt", "main/NaCl/nk/Li.yml"),
    ("KCl", "potassium chloride", "main/KCl/nk/Li.yml"),
    ("KBr", "potassium bromide", "main/KBr/nk/Li.yml"),
    ("CsI", "caesium iodide", "main/CsI/nk/Rodney.yml"),
    ("ZnSe", "zinc selenide", "main/ZnSe/nk/Connolly.yml"),
    ("ZnS", "zinc sulfide, Cleartran", "main/ZnS/nk/Debenham.yml"),
    ("Ge", "germanium", "main/Ge/nk/Burnett.yml"),
    ("Si", "silicon", "main/Si/nk/Salzberg.yml"),
    ("Si visible", "silicon visible", "main/Si/nk/Green-2008.yml"),
    ("GaAs", "gallium arsenide", "main/GaAs/nk/Skauli.yml"),
    ("GaP", "gallium phosphide", "main/GaP/nk/Bond.yml"),
    ("CdTe", "cadmium telluride", "main/CdTe/nk/Marple.yml"),
    ("diamond", "", "main/C/nk/Peter.yml"),
    ("TiO2 o", "TiO2, rutile", "main/TiO2/nk/Devore-o.yml"),
    ("TiO2 e", "", "main/TiO2/nk/Devore-e.yml"),
    ("YAG", "Y3Al5O12, yttrium aluminium garnet", "main/Y3Al5O12/nk/Zelmon.yml"),
    ("MgO", "magnesium oxide", "main/MgO/nk/Stephens.yml"),
    ("Y2O3", "yttria", "main/Y2O3/nk/Nigara.yml"),
    ("SrTiO3", "strontium titanate", "main/SrTiO3/nk/Bond.yml"),
    ("KDP o", "KDP", "main/KH2PO4/nk/Zernike-o.yml"),
    ("KDP e", "", "main/KH2PO4/nk/Zernike-e.yml"),
    ("ADP o", "ADP", "main/NH4H2PO4/nk/Zernike-o.yml"),
    ("ADP e", "", "main/NH4H2PO4/nk/Zernike-e.yml"),
    ("BBO o", "BBO", "main/BaB2O4/nk/Eimerl-o.yml"),
    ("BBO e", "", "main/BaB2O4/nk/Eimerl-e.yml"),
    ("calcite o", "calcite, CaCO3", "main/CaCO3/nk/Ghosh-o.yml"),
    ("calcite e", "", "main/CaCO3/nk/Ghosh-e.yml"),
    ("LiNbO3 o", "lithium niobate", "main/LiNbO3/nk/Zelmon-o.yml"),
    ("LiNbO3 e", "", "main/LiNbO3/nk/Zelmon-e.yml"),
    ("YVO4 o", "YVO4", "main/YVO4/nk/Shi-o-20C.yml"),
    ("YVO4 e", "", "main/YVO4/nk/Shi-e-20C.yml"),
    ("TeO2 o", "TeO2", "main/TeO2/nk/Uchida-o.yml"),
    ("TeO2 e", "", "main/TeO2/nk/Uchida-e.yml"),
    ("Ta2O5", "tantala", "main/Ta2O5/nk/Gao.yml"),
    ("HfO2", "hafnia", "main/HfO2/nk/Al-Kuhaili.yml"),
    ("Nb2O5", "niobia", "main/Nb2O5/nk/Lemarchand.yml"),
    ("Si3N4", "silicon nitride", "main/Si3N4/nk/Luke.yml"),
    ("water", "H2O", "main/H2O/nk/Daimon-20.0C.yml"),
    ("water absorbing", "", "main/H2O/nk/Hale.yml"),
    ("air", "", "other/mixed gases/air/nk/Ciddor.yml"),
    ("nitrogen", "N2", "main/N2/nk/Peck-15C.yml"),
    ("helium", "He", "main/He/nk/Mansfield.yml"),
    ("PMMA", "acrylic, poly(methyl methacrylate)", "organic/(C5H8O2)n - poly(methyl methacrylate)/nk/Sultanova.yml"),
    ("polycarbonate", "PC", "organic/(C16H14O3)n - polycarbonate/nk/Sultanova.yml"),
    ("polystyrene", "PS", "organic/(C8H8)n - polystyrene/nk/Sultanova.yml"),
    ("ethanol", "", "organic/C2H6O - ethanol/nk/Rheims.yml"),
    ("glycerol", "", "organic/C3H8O3 - glycerol/nk/Rheims.yml"),
    ("B270", "", "specs/schott/misc/B270.yml"),
    ("D263TECO", "", "specs/schott/misc/D263TECO.yml"),
    ("LITHOSIL-Q", "", "specs/schott/misc/LITHOSIL-Q.yml"),
    ("ZERODUR", "", "specs/schott/misc/ZERODUR.yml"),
    ("IRG22", "", "specs/schott/infrared/IRG22.yml"),
    ("IRG23", "", "specs/schott/infrared/IRG23.yml"),
    ("IRG24", "", "specs/schott/infrared/IRG24.yml"),
    ("IRG25", "", "specs/schott/infrared/IRG25.yml"),
    ("IRG26", "", "specs/schott/infrared/IRG26.yml"),
    ("IRG27", "", "specs/schott/infrared/IRG27.yml"),
    ("aluminium", "Al, aluminum", "main/Al/nk/Rakic.yml"),
    ("silver", "Ag", "main/Ag/nk/Johnson.yml"),
    ("gold", "Au", "main/Au/nk/Johnson.yml"),
    ("copper", "Cu", "main/Cu/nk/Johnson.yml"),
    ("nickel", "Ni", "main/Ni/nk/Johnson.yml"),
    ("chromium", "Cr, chrome", "main/Cr/nk/Johnson.yml"),
    ("iron", "Fe", "main/Fe/nk/Johnson.yml"),
    ("cobalt", "Co", "main/Co/nk/Johnson.yml"),
    ("palladium", "Pd", "main/Pd/nk/Johnson.yml"),
    ("titanium", "Ti", "main/Ti/nk/Johnson.yml"),
    ("vanadium", "V", "main/V/nk/Johnson.yml"),
    ("manganese", "Mn", "main/Mn/nk/Johnson.yml"),
    ("tungsten", "W", "main/W/nk/Weaver.yml"),
    ("rhodium", "Rh", "main/Rh/nk/Weaver.yml"),
    ("platinum", "Pt", "main/Pt/nk/Rakic-BB.yml"),
    ("beryllium", "Be", "main/Be/nk/Rakic-BB.yml"),
    ("tantalum", "Ta", "main/Ta/nk/Werner.yml"),
    ("molybdenum", "Mo", "main/Mo/nk/Werner.yml"),
    ("magnesium", "Mg", "main/Mg/nk/Hagemann.yml"),
    ("iridium", "Ir", "main/Ir/nk/Roberts.yml"),
]


def plain(text):
    """A reference without mark-up, on one line."""
    text = re.sub(r"<br\s*/?>", " ", text)
    text = html.unescape(re.sub(r"<[^>]*>", "", text))
    return re.sub(r"\s+", " ", text.replace("\\", "")).strip()


def source(document):
    """What the numbers were taken from; links to copies of the maker's sheets are left out."""
    text = plain(re.split(r"\(obtained from|See also", document["REFERENCES"])[0])
    return re.split(r" ?\* ?(?=Ref|Sellmeier)|\[Calculation|\(Numerical data", text)[0].rstrip(" .")


def conditions(document):
    """The temperature and, of gases, the pressure that the numbers hold at, in brackets; empty where nothing is said."""
    stated = document.get("CONDITIONS") or {}
    units = [("temperature", "K"), ("pressure", "Pa")]
    words = [f"{stated[key]} {unit}" for key, unit in units if key in stated]
    return f" (at {', '.join(words)})" if words else ""


def coefficients(part):
    return [float(word) for word in str(part["coefficients"]).split()]


def number(value):
    return f"{value:.12g}"


def agf_formula(part):
    """Number and coefficients of the formula in AGF files, or None."""
    numbers = coefficients(part)
    pairs = list(zip(numbers[1::2], numbers[2::2]))
    if part["type"] == "formula 2" and numbers[0] == 0:
        pairs = [pair for pair in pairs if pair[0] != 0]
        formula = {1: 2, 2: 2, 3: 2, 4: 6, 5: 11}[len(pairs)]
        return formula, [value for pair in pairs for value in pair]
    if part["type"] != "formula 3":
        return None
    by_power = {0.0: numbers[0]}
    for factor, power in pairs:
        by_power[power] = by_power.get(power, 0.0) + factor
    for formula, powers in [
        (1, [0, 2, -2, -4, -6, -8]),
        (10, [0, 2, -2, -4, -6, -8, -10, -12]),
        (12, [0, 2, -2, -4, -6, -8, 4, 6]),
        (13, [0, 2, 4, -2, -4, -6, -8, -10, -12]),
    ]:
        if set(by_power) <= set(powers):
            values = [by_power.get(power, 0.0) for power in powers]
            while values[-1] == 0:
                values.pop()
            return formula, values
    return None


def table(part):
    return [[float(word) for word in line.split()] for line in part["data"].strip().splitlines()]


def transmittances(rows):
    """(wavelength, transmittance, thickness): with the thickness in mm that gives the roundest numbers, which is the one measured."""
    def at(thickness):
        return [math.exp(-4e3 * math.pi * k * thickness / wavelength) for wavelength, k in rows]

    def residual(thickness):
        return sum(abs(tau * 1000 - round(tau * 1000)) for tau in at(thickness))

    best = min((25, 10, 5, 2), key=lambda thickness: (residual(thickness) > 0.01 * len(rows), residual(thickness)))
    digits = 3 if residual(best) <= 0.01 * len(rows) else 5
    return [(row[0], round(tau, digits), best) for row, tau in zip(rows, at(best))]


def agf_record(name, document):
    formula = next(part for part in document["DATA"] if part["type"].startswith(("formula", "tabulated n")))
    agf = agf_formula(formula) if formula["type"].startswith("formula") else None
    if agf is None or "Vd" not in document.get("PROPERTIES", {}):
        return None
    properties = document.get("PROPERTIES", {})
    code = properties.get("glass_code", 0)
    lines = [f"NM {name} {agf[0]} {code} {properties['nd']} {properties['Vd']} 0 0"]
    lines.append("CD " + " ".join(number(value) for value in agf[1]))
    lines.append("LD " + " ".join(str(formula["wavelength_range"]).split()))
    for part in document["DATA"]:
        if part["type"] == "tabulated k":
            for wavelength, tau, thickness in transmittances(table(part)):
                lines.append(f"IT {number(wavelength)} {number(tau)} {thickness}")
    return lines


def write_maker(database, maker, title, folders, take):
    files = [file for folder in folders for file in sorted((database / "specs" / maker / folder).glob("*.yml"))]
    records, sources, left_out = [], {}, []
    for file in files:
        if not re.fullmatch(take, file.stem):
            continue
        document = yaml.safe_load(file.read_text(encoding="utf-8"))
        record = agf_record(file.stem, document)
        if record is None:
            left_out.append(file.stem)
            continue
        records.append((source(document), record))
        sources[source(document)] = sources.get(source(document), 0) + 1
    common = max(sources, key=sources.get)
    lines = [f"CC {common}, through the refractiveindex.info database (CC0)"]
    for origin, record in records:
        lines += record[:1] + ([f"GC {origin}"] if origin != common else []) + record[1:]
    (HERE / f"{maker}.agf").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(title, len(records), "left out:", left_out, "sources:", sources)


def write_materials(database):
    text = ["# From the refractiveindex.info database (public domain, CC0) by make_catalogue.py, reduced to references and numbers."]
    for name, aliases, path in MATERIALS:
        document = yaml.safe_load((database / path).read_text(encoding="utf-8"))
        reference = source(document).replace('"', "'") + conditions(document)
        text += ["---", f'NAME: "{name}"', f'ALIASES: "{aliases}"', f'REFERENCES: "{reference}"', "DATA:"]
        for part in document["DATA"]:
            text.append(f"  - type: {part['type']}")
            for key in ("wavelength_range", "coefficients"):
                if key in part:
                    text.append(f"    {key}: {part[key]}")
            if "data" in part:
                text.append("    data: |")
                rows = [line.split() for line in part["data"].strip().splitlines()]
                text += ["        " + " ".join(row) for row in rows if WINDOW_UM[0] <= float(row[0]) <= WINDOW_UM[1]]
        properties = document.get("PROPERTIES") or {}
        known = {key: properties[key] for key in ("nd", "Vd") if key in properties}
        if known:
            text.append("PROPERTIES:")
            text += [f"    {key}: {value}" for key, value in known.items()]
    (HERE / "materials.yml").write_text("\n".join(text) + "\n", encoding="utf-8")
    print(len(MATERIALS), "materials")


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    for maker in MAKERS:
        write_maker(folder, *maker)
    write_materials(folder)
