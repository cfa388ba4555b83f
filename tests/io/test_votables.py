"""Tables of VOTable files."""

import re

import numpy as np
import pytest
from astropy.table import Table

from uvshear.errors import DataWarning, InputError
from uvshear.io.catalogue import read_catalogue
from uvshear.io.votables import COORDINATE_SYSTEM, read_votable

DOCUMENT = """<?xml version="1.0"?>
<VOTABLE version="1.4" xmlns="http://www.ivoa.net/xml/VOTable/v1.3">
 <RESOURCE>{systems}
  <TABLE name="sources">
   <FIELD ID="col1" name="id" datatype="char" arraysize="*"/>
   <FIELD ID="col2" name="ra" datatype="double" unit="deg"{ref}/>
   <FIELD ID="col3" name="dec" datatype="double" unit="deg"{ref}/>
   <FIELD ID="col4" name="flux" datatype="float" unit="mJy"/>
   <DATA><TABLEDATA>
    <TR><TD>a</TD><TD>60.0</TD><TD>-30.0</TD><TD>1</TD></TR>
    <TR><TD>bcd</TD><TD>60.1</TD><TD>-30.1</TD><TD>2</TD></TR>
   </TABLEDATA></DATA>
  </TABLE>{more}
 </RESOURCE>
</VOTABLE>
"""
B1950 = '<COOSYS ID="old" system="eq_FK4" equinox="B1950"/>'
J2000 = '<COOSYS ID="new" system="eq_FK5" equinox="J2000"/>'


def _write(tmp_path, systems="", ref="", more=""):
    path = tmp_path / "list.xml"
    path.write_text(DOCUMENT.format(systems=systems, ref=ref, more=more))
    return path


def test_columns_have_their_names(tmp_path):
    table = read_votable(_write(tmp_path), None)
    assert table.colnames == ["id", "ra", "dec", "flux"]
    assert COORDINATE_SYSTEM not in (table["ra"].info.meta or {})


def test_text_of_any_length_is_an_identifier(tmp_path):
    catalogue = read_catalogue(_write(tmp_path))
    assert catalogue.identifier.tolist() == ["a", "bcd"]
    np.testing.assert_allclose(np.degrees(catalogue.ra), [60.0, 60.1])


@pytest.mark.parametrize(
    ("systems", "ref", "moved"),
    [
        (B1950, "", True),
        (J2000, "", False),
        (B1950 + J2000, ' ref="old"', True),
        (B1950 + J2000, ' ref="new"', False),
        (B1950 + J2000, "", False),
        ('<COOSYS ID="i" system="ICRS" equinox="J2000"/>', ' ref="i"', False),
    ],
)
def test_positions_are_in_the_system_to_which_they_refer(tmp_path, systems, ref, moved):
    ra = np.degrees(read_catalogue(_write(tmp_path, systems, ref)).ra)
    # Half a degree is the precession of 50 years.
    assert np.allclose(ra, [60.0, 60.1]) is not moved
    assert np.allclose(ra, [60.5, 60.6], atol=0.01) is moved


def test_galactic_positions_are_refused(tmp_path):
    path = _write(tmp_path, '<COOSYS ID="g" system="galactic"/>')
    with pytest.raises(InputError, match=r"list\.xml: its positions are in the system 'galactic'"):
        read_catalogue(path)


SECOND = """<TABLE name="images"><FIELD name="url" datatype="char" arraysize="*"/><DATA><TABLEDATA>
<TR><TD>x</TD></TR></TABLEDATA></DATA></TABLE>"""


def test_the_table_with_sources_is_found_among_several(tmp_path):
    path = _write(tmp_path, more=SECOND)
    with pytest.warns(DataWarning, match=re.escape("table 1 (sources) is read")):
        assert len(read_catalogue(path)) == 2
    assert len(read_catalogue(f"{path}[sources]")) == 2
    with pytest.raises(InputError, match=r"list.xml\[3\]: has no such table"):
        read_catalogue(f"{path}[3]")


def test_sexagesimal_text_with_vizier_s_units_is_read(tmp_path):
    table = Table({"id": [1], "ra": ["04 00 00"], "dec": ["-30 30 00"], "flux": [1.0]})
    path = tmp_path / "list.vot"
    table.write(path, format="votable")
    text = path.read_text()
    for name, unit in (("ra", "h:m:s"), ("dec", "d:m:s"), ("flux", "mJy")):
        text = text.replace(
            f'name="{name}"',
            f'name="{name}" unit="&quot;{unit}&quot;"'
            if ":" in unit
            else f'name="{name}" unit="{unit}"',
        )
    path.write_text(text)
    catalogue = read_catalogue(path)
    assert np.degrees(catalogue.ra[0]) == pytest.approx(60.0)
    assert np.degrees(catalogue.dec[0]) == pytest.approx(-30.5)
