# SPDX-License-Identifier: Apache-2.0
"""IDL is read as rosidl reads it, and else refused with the place and a way out."""

import pytest

from schemas.definition import DefinitionError, FieldType
from schemas.definition_text import parse_definition
from schemas.idl import MAX_MODULES, parse_idl_interface, parse_idl_message
from schemas.idl_tokens import MAX_CHARACTERS
from schemas.installed import InstalledDefinitions, installed_prefixes
from schemas.interface import Interface, parse_interface

NAME = "some_msgs/msg/Thing"
DEFINITIONS = InstalledDefinitions()


def idl_files():
    """Return the installed types that have IDL next to their .msg, .srv or .action."""
    found = {}
    for name in DEFINITIONS.all_names():
        package, kind, short_name = name.split("/")
        for prefix in installed_prefixes():
            path = prefix / "share" / package / kind / f"{short_name}.idl"
            if path.is_file():
                if path.with_suffix(f".{kind}").is_file():
                    found[name] = path
                break
    return found


def parts(definition):
    return list(definition.parts.values()) if isinstance(definition, Interface) else [definition]


def parsed(name, text):
    return (parse_idl_message if "/msg/" in name else parse_idl_interface)(name, text)


def as_in_msg(name, text):
    return (parse_definition if "/msg/" in name else parse_interface)(name, text)


def contents(definition):
    """Return all but the comments."""
    fields = [(f.name, f.type, f.default) for f in definition.fields]
    constants = [(c.name, c.type, c.value) for c in definition.constants]
    return definition.name, fields, constants


def wrapped(body):
    return f"module some_msgs {{ module msg {{\n{body}\n}}; }};"


def thing(body):
    return parse_idl_message(NAME, wrapped(body))


def field_type(text, before=""):
    (field,) = thing(f"{before} struct Thing {{ {text} x; }};").fields
    return field.type


def test_every_installed_type_reads_the_same_from_idl_and_from_its_own_file():
    files = idl_files()
    for name, path in files.items():
        from_idl = parsed(name, path.read_text(encoding="utf-8"))
        assert list(map(contents, parts(from_idl))) == list(
            map(contents, parts(DEFINITIONS.get_any(name)))
        )
    assert len(files) > 150


def test_the_text_of_every_installed_type_reads_as_the_same_definition():
    files = idl_files()
    for name, path in files.items():
        from_idl = parsed(name, path.read_text(encoding="utf-8"))
        for one, again in zip(parts(from_idl), parts(as_in_msg(name, from_idl.text)), strict=True):
            assert (again.fields, again.constants) == (one.fields, one.constants)
            assert again.comment == one.comment


def test_comments_of_a_struct_its_members_and_its_constants_are_kept():
    definition = thing("""
        module Thing_Constants { @verbatim(language="comment", text="one") const octet A = 1; };
        @verbatim(language="comment", text="two" "\\n" "lines") @verbatim(language="x", text="y")
        struct Thing {
          @verbatim(language="comment", text="far") @unit(value="m") double x;
          @unit("s") double y;
          @verbatim(language="c++", text="code") double z;
        };
    """)
    assert definition.comment == "two\nlines"
    assert [field.comment for field in definition.fields] == ["far [m]", "[s]", ""]
    assert [constant.comment for constant in definition.constants] == ["one"]


@pytest.mark.parametrize(
    ("written", "base"),
    [
        ("boolean", "bool"), ("octet", "byte"), ("char", "char"), ("float", "float32"),
        ("double", "float64"), ("short", "int16"), ("unsigned short", "uint16"),
        ("long", "int32"), ("unsigned long", "uint32"), ("long long", "int64"),
        ("unsigned long long", "uint64"), ("unsigned\n long /* */ long // \n", "uint64"),
        ("string", "string"), ("wstring", "wstring"), ("a::msg::B", "a/msg/B"),
        ("::a::msg::B", "a/msg/B"), *((name, name) for name in (
            "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"
        )),
    ],
)  # fmt: skip
def test_each_type_has_its_name_in_msg_files(written, base):
    assert field_type(written) == FieldType(base)
    assert field_type(f"sequence<{written}>") == FieldType(base, is_sequence=True)
    assert field_type("Alias", f"typedef {written} Alias;") == FieldType(base)


@pytest.mark.parametrize(
    ("written", "before", "read"),
    [
        ("string<5>", "", "string<=5"),
        ("wstring<0x10>", "", "wstring<=16"),
        ("sequence<string<3>, 4>", "", "string<=3[<=4]"),
        ("double__9", "typedef double double__9[9];", "float64[9]"),
        ("B2", "typedef a::msg::B B; typedef B B2[010];", "a/msg/B[8]"),
        ("Many", "typedef sequence<octet, 3> Many;", "byte[<=3]"),
        ("Many", "typedef sequence<octet> Many; typedef sequence<octet> Many;", "byte[]"),
        ("sequence<One>", "typedef string<2> One;", "string<=2[]"),
    ],
)
def test_bounds_and_typedefs_are_read(written, before, read):
    assert str(field_type(written, before)) == read


def test_several_names_and_sizes_stand_behind_a_type():
    definition = thing("struct Thing { short a, b; @key long c, d[3]; string<2> e[4]; };")
    assert [(field.name, str(field.type)) for field in definition.fields] == [
        ("a", "int16"), ("b", "int16"), ("c", "int32"), ("d", "int32[3]"), ("e", "string<=2[4]")
    ]  # fmt: skip


def test_defaults_are_of_the_type_of_their_field():
    definition = thing(r"""struct Thing {
        @default(value=TRUE) boolean a;
        @default (value=-3) long b;
        @default (value=+2) double c;
        @default (value=1.5e-1d) float d;
        @default (value="two " "words") string e;
        @default (value=L"Gr\u00fc\xdfe") wstring<6> f;
        @default (value="(True, False)") boolean g[2];
        @default (value="('it\\'s', \"a, b\", '\\n')") sequence<string> h;
        @default (value="()") sequence<double> i;
        @default (value=" ( 1 , -2.5, 3, ) ") sequence<double, 3> j;
    };""")
    values = [field.default for field in definition.fields]
    assert values == [
        True, -3, 2.0, 0.15, "two words", "Grüße", (True, False), ("it's", "a, b", "\n"), (),
        (1.0, -2.5, 3.0),
    ]  # fmt: skip
    assert [type(value) for value in values[:4]] == [bool, int, float, float]


def test_constants_belong_to_the_struct_of_their_module():
    definition = thing("""
        const long OF_NOBODY = 1;
        struct Thing { octet x; };
        module Other_Constants { const long X = 2; };
        module Thing_Constants {
          const string<3> NAME = "abc"; const double SHARE = 1; const int8 LEAST = -0x80;
        };
    """)
    assert [(c.name, c.type, c.value) for c in definition.constants] == [
        ("NAME", "string", "abc"), ("SHARE", "float64", 1.0), ("LEAST", "int8", -128)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("annotation", "is_key"),
    [("@key", True), ("@key(TRUE)", True), ("@key(FALSE)", False), ("", False)],
)
def test_a_key_is_known(annotation: str, is_key: bool):
    struct = f"struct Thing {{ boolean a; {annotation} long b; }};"
    text = f"module some_msgs {{ module msg {{ {struct} }}; }};"
    definition = parse_idl_message(NAME, text)
    assert [field.is_key for field in definition.fields] == [False, is_key]
    assert definition.is_keyed is is_key


def test_annotations_without_effect_in_ros_are_skipped():
    definition = parse_idl_message(
        NAME,
        """\ufeff// made by hand
        #include "a/msg/B.idl"
        # include <c/msg/D.idl>
        @module_note(text=")", more=(1 << 2), @) module some_msgs {
          @transfer_mode(SHMEM) module msg {
          #include "e/msg/F.idl"
          struct Thing;
          /* struct Nothing { **/
          @nested @ns::extensibility(APPENDABLE) struct Thing {
            @key @range(min=-1, max=(1)) @optional long module; // a word of IDL
            long sequence, struct_, string;
          };
        }; };""",
    )
    assert [field.name for field in definition.fields] == [
        "module",
        "sequence",
        "struct_",
        "string",
    ]


def test_a_struct_without_members_is_an_empty_message():
    assert thing("struct Thing { uint8 structure_needs_at_least_one_member; };").fields == ()
    assert thing("struct Thing { int8 structure_needs_at_least_one_member; };").fields != ()


def test_a_service_and_an_action_are_the_structs_of_their_parts():
    name = "some_msgs/srv/Do"
    request = "struct Do_Request { octet a; };"
    constants = "module Do_Response_Constants { const octet A = 1; };"
    response = f"{constants} struct Do_Response {{ octet b; }};"
    for text in (request + response, response + request):
        hashes = {name: "all", f"{name}_Request": "one"}
        service = parse_idl_interface(name, f"module some_msgs{{module srv{{{text}}};}};", hashes)
        assert list(service.parts) == ["request", "response"]
        assert service.text == "byte a\n---\nbyte A=1\nbyte b\n"
        assert service.type_hash == "all"
        assert [part.type_hash for part in service.parts.values()] == ["one", None]


def fault(body):
    with pytest.raises(DefinitionError) as caught:
        thing(body)
    return str(caught.value).removeprefix("some_msgs/msg/Thing.idl, ")


def test_an_error_names_the_file_the_line_and_the_column():
    with pytest.raises(DefinitionError) as caught:
        parse_idl_message(
            NAME, "module some_msgs {\n  module msg {\n    struct Thing {\n  octet 5;"
        )
    assert str(caught.value) == (
        "some_msgs/msg/Thing.idl, line 4, column 9: expected a name, got 5"
    )


A_TYPE = "expected a type: a typedef from above, or PACKAGE::msg::NAME"
A_SIZE = "expected a number from 1 to 4294967295; rosidl takes no name or sum"
A_DEFAULT = 'expected a default such as "(1, 2, 3)"'
A_VALUE = "expected a number, a string, TRUE or FALSE; rosidl takes no name or sum"
A_NUMBER = "expected a number such as 12, 0x1f or 1.5e3"
NO_ENUM = "rosidl has no enums; use an integer, and constants in a module NAME_Constants"
NO_STRUCT = "rosidl has no struct in a struct; give it a file, and name it PACKAGE::msg::NAME"
NO_MEMBERS = (
    "expected members in Thing; IDL has no empty struct, rosidl writes"
    " uint8 structure_needs_at_least_one_member into it"
)
NO_DIRECTIVE = 'expected #include "PACKAGE/msg/NAME.idl", the only directive that rosidl reads'
LONG = "a" * 5000
ONE = "struct Thing { octet x; };"
A_BRACE = "expected } at the end of module some_msgs"
A_QUOTE = 'expected a " at the end of this string; close it on the same line'
HUGE = f"0x{'f' * 5000}"
SURROGATE = "a string cannot hold a lone surrogate"
A_STRUCT = "expected exactly the structs some_msgs/msg/Thing"
RENAME = "name modules and structs like the file"


@pytest.mark.parametrize(
    ("member", "reason"),
    [
        ("long double x;", "ROS has no long double; use double"),
        ("wchar x;", "rosidl makes no code for wchar; use uint16"),
        ("fixed<3, 2> x;", "rosidl has no fixed-point numbers; use double"),
        ("Other x;", f"{A_TYPE}, got Other"),
        ("a::Other x;", f"{A_TYPE}, got a::Other"),
        ("a::srv::B x;", f"{A_TYPE}, got a::srv::B"),
        ("map<string, long> x;", "rosidl does not read this; use structs, sequences and integers"),
        ("union x {};", "rosidl has no unions; use a member for each of its cases"),
        ("unsigned double x;", "expected short or long, got double"),
        ("sequence<sequence<long>> x;", "rosidl has no sequence here; use a struct for it"),
        ("sequence<Three> x;", "rosidl has no sequence of float64[3]; use a struct for it"),
        ("Three x[2];", "rosidl has no array of float64[3]; use a struct for it"),
        ("long x[2][3];", "expected ; behind an array of one dimension, got ["),
        ("long x[2], y;", "expected ; behind an array of one dimension, got ,"),
        ("long x[0];", f"{A_SIZE}, got 0"),
        ("string<4294967296> x;", f"{A_SIZE}, got 4294967296"),
        ("sequence<long, N> x;", f"{A_SIZE}, got N"),
        ("sequence<long, 1.5> x;", f"{A_SIZE}, got 1.5"),
        ("string<1 + 1> x;", "expected >, got +"),
        ("long x = 5;", "expected ;, got ="),
        ("long x, x;", "the second member x; rename it"),
        ("long a__b;", "a__b is not a valid field name in ROS; rename it"),
        ("long _x;", "expected a letter at the start of a name, as rosidl does; leave out the _"),
        ("@default(value=300) octet x;", "expected a value of byte, got 300"),
        ("@default(value=1.5) long x;", "expected a value of int32, got 1.5"),
        ("@default(value=1) boolean x;", "expected a value of bool, got 1"),
        ("@default(value=TRUE) long x;", "expected a value of int32, got TRUE"),
        ('@default(value="1") long x;', 'expected a value of int32, got "1"'),
        ("@default(value=5) string x;", "expected a value of string, got 5"),
        ("@default(value=X) long x;", f"{A_VALUE}, got X"),
        ("@default(value=1 | 2) long x;", "expected ), got |"),
        ("@default(value=10UL) long x;", f"{A_NUMBER}, got 10UL"),
        (f"@default(value={'9' * 5000}) long x;", f"{A_NUMBER}, got {'9' * 40}..."),
        (f"@default(value={HUGE}) double x;", f"expected a value of float64, got {HUGE[:40]}..."),
        ("@default(value=1) a::msg::B x;", "a a/msg/B has no default; leave it out"),
        ("@default(value=1) sequence<long> x;", f"{A_DEFAULT}, got 1"),
        ('@default(value="1, 2") sequence<long> x;', f'{A_DEFAULT}, got "1, 2"'),
        ('@default(value="(1 2)") sequence<long> x;', f'{A_DEFAULT}, got "(1 2)"'),
        ('@default(value="((1,))") sequence<long> x;', f'{A_DEFAULT}, got "((1,))"'),
        ('@default(value="(x,)") sequence<long> x;', f'{A_DEFAULT}, got "(x,)"'),
        ('@default(value="(1, 2)") long x[3];', "2 elements are no default of int32[3]"),
        ('@default(value="(1, 2)") sequence<int8, 1> x;', "2 elements are no default of int8[<=1]"),
        ('@default(value="(1.5,)") long x[1];', 'expected a value of int32, got "(1.5,)"'),
        (r'@default(value="\x00") string x;', "a string cannot hold U+0000"),
        (r'@default(value=L"\ud83e") wstring x;', SURROGATE),
        (r'@default(value="(\'\\ud83e\',)") sequence<string> x;', SURROGATE),
        ("long x: 3;", "expected ;, got :"),
    ],
)  # fmt: skip
def test_idl_that_rosidl_does_not_read_is_refused_with_a_way_out(member, reason):
    body = f"typedef double Three[3];\nstruct Thing {{ {member} }};"
    assert fault(body).partition(": ")[2] == reason


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("enum Colour { RED };", NO_ENUM),
        ("union U switch (long) {};", "rosidl has no unions; use a member for each of its cases"),
        ("struct Thing : Other { octet x; };", "rosidl has no inheritance; repeat the members"),
        ("struct Thing {};", NO_MEMBERS),
        (f"{ONE} struct Thing {{ octet y; }};", "the second struct Thing; rename it"),
        ("typedef long a, b;", "rosidl reads one name in a typedef; write two"),
        ("typedef long a; typedef short a;", "the second typedef a, of another type; rename it"),
        ("typedef struct A { octet x; } B;", NO_STRUCT),
        ("const a::msg::B X = 1;", "expected a number, a boolean or a string, got a/msg/B"),
        ("const sequence<long> X = 1;", "expected a number, a boolean or a string, got int32[]"),
        ("const octet A__B = 1;", "A__B is not a valid constant name in ROS; rename it"),
        ("const octet X = 'a';", "rosidl reads no literals of characters; write a number"),
        ("const octet X = -TRUE;", f"{A_VALUE}, got TRUE"),
        ("const octet X = 1; const octet X = 1;", "the second constant X; rename it"),
        ('const string X = "a', A_QUOTE),
        ("#define X 1", NO_DIRECTIVE),
        ("/* open", "expected */ behind the /* here; close the comment"),
        ("struct Thing { octet x; } $", "expected IDL, got '$'; remove it"),
        ("octet x;", "expected module, struct, const, typedef or #include, got octet"),
        ("struct Thing { octet x; }", "expected ;, got }"),
        ("@note(", "expected ), got the end of the file"),
        (f"module a {{ {ONE}", f"{A_BRACE}, got the end of the file"),
        ("struct Other { octet x; };", f"{A_STRUCT}, got some_msgs/msg/Other; {RENAME}"),
        (f"{ONE} struct B {{ octet x; }};", f"{A_STRUCT}, got {NAME}, some_msgs/msg/B; {RENAME}"),
        ("struct Thing;", f"{A_STRUCT}, got none; {RENAME}"),
    ],
)  # fmt: skip
def test_other_declarations_are_refused_with_a_way_out(body, reason):
    assert fault(body).partition(": ")[2] == reason


def test_a_struct_of_another_module_is_not_the_message():
    with pytest.raises(DefinitionError, match="got other_msgs/msg/Thing; name modules"):
        parse_idl_message(NAME, "module other_msgs { module msg { struct Thing { octet x; }; }; };")


def test_only_so_many_modules_are_read_within_each_other():
    deep = "module m { " * (MAX_MODULES - 2)
    thing(f"{deep} const octet X = 1; {'}; ' * (MAX_MODULES - 2)} struct Thing {{ octet x; }};")
    assert "at most 8 modules within each other" in fault(f"module m {{ {deep}")


def test_only_so_much_text_is_read():
    text = wrapped("struct Thing { octet x; };")
    parse_idl_message(NAME, text.ljust(MAX_CHARACTERS))
    with pytest.raises(DefinitionError, match="at most 131072 characters are read"):
        parse_idl_message(NAME, text.ljust(MAX_CHARACTERS + 1))


# rosidl itself is the judge of these

READ_BY_ROSIDL = [
    "struct Thing { short a, b; long c, d[3]; };",
    "typedef string<3> S; struct Thing { S x; sequence<S, 2> y; wstring<4> z; };",
    "typedef sequence<a::msg::B, 4> Many; struct Thing { Many x; };",
    'struct Thing { @default(value="a\\\\\\"b\\n\\x41\\101\\?") string x; };',
    'struct Thing { @default(value=L"\\u2122" L"x") wstring x; @default(value=1.9e10) double y; };',
    "struct Thing { @default(value=8.7d) double a; @default(value=.5) float b; };",
    "struct Thing { @default(value=-10) long long a; @key @range(min=-1, max=1) octet b; };",
    """module Thing_Constants {
        const unsigned long A = 42; const float B = 1.25; const boolean C = FALSE;
        const string D = "a" "b"; const wstring E = L"\\u2122";
    }; struct Thing { long x; };""",
]
REFUSED_BY_ROSIDL = [
    "struct Thing { Other x; };",
    "struct Thing { long x[2][3]; };",
    "struct Thing { long x[N]; };",
    "struct Thing { fixed<3, 2> x; };",
    "struct Thing { };",
    "struct Thing : Other { long x; };",
    "struct Thing { long _x; };",
    "enum E { A }; struct Thing { E x; };",
    "union U switch (long) { case 1: long x; }; struct Thing { long x; };",
    "typedef long a, b; struct Thing { a x; };",
    "struct Thing { @default(value=1 + 2) long x; };",
    "struct Thing { @default(value='a') long x; };",
    "#define A 1\nstruct Thing { long x; };",
    "struct Thing { map<long, long> x; };",
    "struct Thing { long x; }",
]


def rosidl_type(kind):
    """Write a type of rosidl's as `FieldType` does."""
    from rosidl_parser import definition as rosidl

    if isinstance(kind, rosidl.AbstractNestedType):
        base = rosidl_type(kind.value_type)
        if isinstance(kind, rosidl.Array):
            return f"{base}[{kind.size}]"
        return f"{base}[<={kind.maximum_size}]" if kind.has_maximum_size() else f"{base}[]"
    if isinstance(kind, rosidl.AbstractGenericString):
        base = "wstring" if isinstance(kind, rosidl.AbstractWString) else "string"
        return f"{base}<={kind.maximum_size}" if kind.has_maximum_size() else base
    if isinstance(kind, rosidl.NamespacedType):
        return "/".join(kind.namespaced_name())
    names = {"float": "float32", "double": "float64", "boolean": "bool", "octet": "byte"}
    return names.get(kind.typename, kind.typename)


@pytest.mark.filterwarnings("ignore:.*invalid escape sequence:DeprecationWarning")  # \\?
@pytest.mark.parametrize("body", READ_BY_ROSIDL)
def test_a_file_is_read_as_rosidl_reads_it(body):
    rosidl = pytest.importorskip("rosidl_parser.parser")
    theirs = rosidl.parse_idl_string(wrapped(body)).elements[-1]
    ours = thing(body)

    def default(member):
        return member.has_annotation("default") and member.get_annotation_value("default")["value"]

    assert [(f.name, str(f.type), f.default or False) for f in ours.fields] == [
        (m.name, rosidl_type(m.type), default(m)) for m in theirs.structure.members
    ]
    assert [(c.name, c.value) for c in ours.constants] == [
        (c.name, c.value) for c in theirs.constants
    ]


@pytest.mark.parametrize("body", REFUSED_BY_ROSIDL)
def test_idl_that_rosidl_refuses_is_refused(body):
    rosidl = pytest.importorskip("rosidl_parser.parser")
    with pytest.raises(Exception):  # noqa: B017, PT011  # lark's errors, assertions, and others
        rosidl.parse_idl_string(wrapped(body))
    fault(body)


@pytest.mark.parametrize(
    "body",
    [
        f"struct Thing {{ {LONG} x; }};",
        f"struct Thing {{ long {LONG}, {LONG}; }};",
        f"struct Thing {{ long {LONG}__; }};",
        f"struct Thing {{ @default(value=1) {LONG}::msg::B x; }};",
        f"typedef {LONG}::msg::B A[2]; struct Thing {{ A x[2]; }};",
        f"typedef {LONG}::msg::B A[2]; struct Thing {{ sequence<A> x; }};",
        f"const {LONG}::msg::B X = 1;",
        f"module {LONG} {{",
        "".join(f"struct {LONG}{number} {{ long x; }};" for number in range(20)),
    ],
)
def test_an_error_is_short_whatever_the_names(body):
    assert len(fault(body)) < 500


@pytest.mark.parametrize(
    ("before", "repeated", "after"),
    [
        ("struct Thing { long a", "a", "__; };"),
        ("struct Thing { long a", "_a", "__; };"),
        ("struct Thing { @default(value=1", "1", "_) long x; };"),
        ("struct Thing { @default(value=1.", "1", ".) double x; };"),
        ("struct Thing { @default(value=1", "e+1", ".) double x; };"),
        ('struct Thing { @default(value="', "\\\\", ") string x; };"),
        ('struct Thing { @default(value="(1', " ", '2)") long x[2]; };'),
        ('struct Thing { @default(value="(', "1,", ')") long x[2]; };'),
        ("struct Thing { @default(value=", '"a"', ") long x; };"),
        ("struct Thing { @note(", "(", ") long x; };"),
        ("struct Thing {", "sequence<", "long x; };"),
        ("struct Thing { long x", ",x", "; };"),
        ("", "typedef long a;", "struct Thing { b x; };"),
        ("", "/* * /", ""),
        ("", " ", "x"),
        ("", "struct A;", "struct Thing { wchar x; };"),
    ],
)
def test_a_file_as_large_as_may_be_is_refused_at_once(before, repeated, after):
    # a reader that takes more than proportional time does not come to an end
    room = MAX_CHARACTERS - len(wrapped(before + after))
    assert fault(before + repeated * (room // len(repeated)) + after)
