# SPDX-License-Identifier: Apache-2.0
"""Requests for clients' code, as the command line makes them, and awkward definitions."""

from schemas.generate.catalogue import Catalogue
from schemas.generate.request import MARK, GenerateRequest
from schemas.installed import InstalledDefinitions, installed_prefixes
from tests.schemas.test_installed import write_definition

GENERATED = f"{MARK}some types; do not edit."

# Names that some language needs for itself, words that could end a comment or a text, and values
# at the ends of their types.
AWKWARD = """\
# A comment that ends */ here, \\ and \"\"\" there, ${x} `y` <b> & so on.

int8 A=1  # one */ more
int64 LEAST=-9223372036854775808
uint64 MOST=18446744073709551615
float32 TENTH=0.1
float64 ENDLESS=inf
float64 NOTHING=nan
string TEXT="a\\"b\\\\ */ ${x}"
int8 class
int8 default
int8 from
int8 object
int8 constructor
int8 self
int8 interface
int8 Data
int8 data
int8 x_
int8 namespace
None none
String text
std_msgs/String other
Array[2] two
Record[] records
int64 long
int64[] longs
uint64[2] pair
float32 tenth 0.1
float64[<=3] few
string<=5 short "ab"
wstring wide "gr\u00fc\u00dfe"
uint8[] octets
byte[4] four
char[<=4] some
bool[] flags
"""
TEXTS = {
    "awkward_msgs/msg/Awkward": AWKWARD,
    "awkward_msgs/msg/None": "int8 x\n",
    "awkward_msgs/msg/String": "int8 x\n",
    "awkward_msgs/msg/Array": "int8 x\n",
    "awkward_msgs/msg/Record": "",
    "awkward_msgs/msg/Uint8Array": "uint8[] x\n",
    "awkward_msgs/srv/Ask": "awkward_msgs/Awkward x\n---\n",
    "awkward_msgs/action/Act": "int8 A=1\n---\nAwkward[] x\n---\nint8 percent\n",
    "default/msg/Thing": "std_msgs/Header header\n",
    "import/msg/Thing": "default/Thing thing\nThing2 two\n",
    "import/msg/Thing2": "int8 x\n",
}


def write_awkward(prefix):
    """Install the awkward definitions below *prefix*."""
    for name, text in TEXTS.items():
        write_definition(prefix, name, text)


def awkward_definitions(prefix):
    """Return what is installed, and the awkward."""
    write_awkward(prefix)
    return InstalledDefinitions([prefix, *installed_prefixes()])


def request_of(*names, definitions=None, **options):
    known = InstalledDefinitions() if definitions is None else definitions
    catalogue = Catalogue.of_types(names, known)
    return GenerateRequest(tuple(sorted(names)), catalogue, GENERATED, **options)


def request_of_everything(definitions, **options):
    return request_of(*definitions.all_names(), definitions=definitions, **options)


def names_of_messages(definitions):
    """Return the names of all messages, those of services and actions included."""
    parts = [
        part.name
        for kind in ("srv", "action")
        for name in definitions.names(kind=kind)
        for part in definitions.interface(name).parts.values()
    ]
    return definitions.names() + parts


def write_texts(folder, texts):
    """Write texts by path below a folder. Return the paths."""
    paths = []
    for path, text in texts.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text, encoding="utf-8")
        paths.append(folder / path)
    return paths
