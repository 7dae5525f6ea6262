# SPDX-License-Identifier: Apache-2.0
"""The rules of a drive, one by one, each as a history. `tests.drive.histories` has the words."""

import pytest

from gateway.drive.burst import BACKLOG
from gateway.drive.effects import Clamped
from gateway.drive.velocity import Velocity
from tests.drive.histories import MS, Stage

# The events that stop a robot which "a" drives, with the cause
STOPS = {
    "leave": "disconnect",
    "revoke": "permission",
    "invalid": "invalid_value",
    "b:stop": "stop",
    "guard=lost": "guard",
    "guard=starting": "reader",
    "shutdown": "shutdown",
}
ENDS = [*STOPS, "release", "b:acquire"]
TRIPPED = "stream=10 1000ms causes=deadline is=tripped >go*10,zero*5 "
READY = "guard=ready end "
HISTORIES = {
    # Deadline and stop
    "a command moves at once": "go >go",
    "after the deadline five zeros come within 250 ms and then nothing": (
        "go 499ms >go 1ms >zero 249ms >zero*4 10000ms > is=stopped"
    ),
    "each command starts the deadline again": "go 400ms go 499ms >go*2 1ms >zero",
    "a zero stops at once and the client may drive on": (
        "stream=10 >go*10 zero >zero go >go is=moving"
    ),
    "the zeros of a stop do not hold back a client that drives on at once": (
        "stream=10 zero >go*10,zero stream=5 >go*5"
    ),
    "zeros of a robot that stands pass": "zeros=3 >zero*3",
    "the newest of a turn goes out": "go >go [ go fast slow ] >slow",
    # The latch
    "after a stop by the deadline only a zero and quiet let it move again": TRIPPED
    + (
        "stream=20 refused=tripped*20 > "
        "zero 249ms go >zero 1000ms go > "  # too early, and the zero is spent
        "zero 250ms go >zero,go"
    ),
    "a refusal says what to send": TRIPPED + 'go says=send_a_zero_command_("msg":{})',
    "a refusal says what has happened": TRIPPED + "go says=commands_stopped_arriving",
    "a refusal during a reset says it too": TRIPPED + "zero go says=commands_stopped_arriving",
    "a stream of zeros resets while it lasts": TRIPPED + "zeros=6 go >zero*6,go",
    **{
        f"a backlog does not move the robot though there are zeros in it, {wait} after": (
            f"stream=10 >go*10 {wait} {'go 0.06ms ' * 30}{'zero 0.06ms ' * 5}{'go 0.06ms ' * 30}"
            "stream=20 stops zero 300ms >zero go >go"
        )
        for wait in ("500ms", "1500ms", "4000ms", "20000ms")
    },
    "a gateway that stood still judges the deadline before what has piled up": (
        "stream=10 >go*10 freeze=3000 go causes=deadline [ go*10 zero go ] go 100ms stops"
    ),
    "a reset that ends late begins again because commands may wait": TRIPPED
    + "zero freeze=3000 [ go*3 ] refused=tripped*3 >zero",
    "a command of a turn during which the gateway stood still does not go out": (
        "[ go freeze=600 ] >zero"
    ),
    "five commands of a turn during which the gateway stood still do not go out": (
        "[ go*5 freeze=600 ] >zero"
    ),
    "many commands at once after a silence are a backlog": (
        f"[ go*{BACKLOG + 1} ] causes=backlog stops go refused=tripped"
    ),
    **{
        f"a backlog of {counts} each {gap} does not move a robot that stood {silence}": (
            f"stream=10 zeros=5 {silence} forget "
            + "".join(f"[ go*{count} ] {gap} " for count in counts)
            + "1000ms causes=backlog stops is=tripped"
        )
        for silence in ("300ms", "4000ms")
        for counts, gap in [
            ((12, 24, 48), "20ms"),
            ((12, 24, 48), "50ms"),
            ((10, 20, 40, 10), "20ms"),
            ((6, 12, 24, 48), "5ms"),
        ]
    },
    "a backlog whose first segment is one command moves until the next one comes": (
        f"go 20ms [ go*{BACKLOG + 4} ] causes=backlog >go,zero is=tripped"
    ),
    "after 250 ms of commands many at once are no backlog": (
        f"go 250ms [ go*{4 * BACKLOG} ] causes=none is=moving"
    ),
    "a command that is proved fresh moves though many zeros came before it": (
        f"[ zero*{BACKLOG + 1} ] go=fresh causes=none is=moving"
    ),
    "a single command 3 ms behind another takes its place": (
        "go 5000ms forget go 3ms go 1000ms >go,zero*5"
    ),
    "a single command closely behind a late one was in a backlog": (
        "go 1000ms forget go=stale 1ms go 1000ms >"
    ),
    "a few commands at once after a silence go out when time has explained them": (
        f"[ go*{BACKLOG} ] > {(BACKLOG - 1) * 1000 / 120 - 0.1}ms > 0.1ms >go "
        "408.2ms is=moving "  # half a second after they came
        "0.2ms causes=deadline is=tripped"  # nobody types so fast
    ),
    "a client that sends zeros all day moves at once after many of them": (
        "[ zero*400 ] 50ms zeros=10 stops go >go"
    ),
    "no command waits for longer than a backlog is ahead": (
        f"[ zero*400 ] 1ms stops go {BACKLOG * 1000 / 120 - 1.1}ms > 0.1ms >go"
    ),
    "an invalid message behind a command of its turn stops and trips": (
        "[ go invalid ] causes=invalid_value stops is=tripped"
    ),
    "an invalid message takes back a command that waits": (
        "go 5000ms >go,zero*5 go 249ms freeze=2 invalid causes=invalid_value 1000ms stops"
    ),
    "a backlog that a slow turn takes is one": "[ go*50 freeze=300 ] causes=backlog stops",
    **{
        f"a robot that moves goes on when its link has hesitated for {stall} ms at {hz} Hz": (
            f"{f'go {1000 / hz}ms ' * hz}{stall - 1000 / hz}ms [ go*{hz * stall // 1000} ] "
            "refused=none causes=none is=moving"
        )
        for hz in (20, 50, 60, 90, 120)
        for stall in (100, 260, 300, 400, 480)
    },
    "a backlog that ends with a zero is one as well": (
        "[ go*30 zero ] 20ms go causes=zero,backlog 1000ms stops"
    ),
    "a backlog is one though another client has sent zeros in between": (
        "p:zeros=40 >zero*40 [ o:go*12 ] 20ms [ o:go*24 ] 20ms [ o:go*48 ] 20ms "
        "causes=backlog stops"
    ),
    "a backlog behind stale commands is one": (
        f"zeros=5 4000ms >zero*5 {'go=stale ' * 10}"
        "5ms [ go*12 ] 5ms [ go*24 ] 5ms [ go*48 ] causes=backlog stops"
    ),
    **{
        f"a zero takes back what waits though it is due since {late} ms": (
            f"[ go*3 ] freeze={2 * 1000 / 120 + late} zero 1000ms stops"
        )
        for late in (0, 20)
    },
    "a zero goes out with its turn though a command before it waited for time": (
        "[ go*3 ] zero 20ms >zero [ zero tick > ] >zero"
    ),
    **{
        f"{end} takes back a command that waits though it is due": (
            f"[ go*3 ] freeze=20 {end} 1000ms stops"
        )
        for end in ENDS
    },
    "a command that is proved fresh waits for nothing": f"[ {'go=fresh ' * 2 * BACKLOG}] >go",
    "a stream goes on at once behind a few commands that came together": (
        "[ slow*3 ] 16ms > 34ms stream=3 refused=none >slow,go*3"
    ),
    "a command that is proved fresh takes the place of one that waits": (
        "[ go slow=fresh ] 100ms >slow"
    ),
    "120 commands a second are not a backlog however busy the loop is": (
        "".join(f"[ go*{n} ] {n * 1000 / 120}ms " for n in (12, 6, 1, 3, 12, 9, 6, 3, 3, 12))
        + "refused=none is=moving"
    ),
    "a stream that goes on is not a backlog": (  # at 500 Hz
        f"{'go 2ms ' * 200}[ go*{10 * BACKLOG} ] refused=none >go*201"
    ),
    # A single command, typed by hand
    "a single command may be sent again after its deadline": (
        "go 5000ms is=free >go,zero*5 go 249ms > 1ms >go 499ms > 1ms >zero"
    ),
    "single commands may be sent one after another": (
        "go 5000ms go 5000ms go 5000ms refused=none >go,zero*5,go,zero*5,go,zero*5"
    ),
    "a single command closely behind a zero does not wait and ends the reset": (
        "go 5000ms zero 100ms >go,zero*6 go refused=tripped 1000ms go >"
    ),
    **{
        f"a single command that is followed after {gap} was in a backlog": (
            f"go 5000ms >go,zero*5 go {gap} go refused=tripped*2 300ms stream=5 >"
        )
        for gap in ("0.1ms", "2.9ms")
    },
    "a stream that follows a single command begins a little later": (
        "go 5000ms >go,zero*5 stream=10 refused=none >go*6"
    ),
    "an uneven stream of 120 Hz behind a single command is not a backlog": (
        f"go 5000ms {f'go {1000 / 120 - 2.5}ms go {1000 / 120 + 2.5}ms ' * 60}"
        "refused=none is=moving"
    ),
    "a command that waits for the guard as well waits no longer than a second": (
        "go 5000ms guard=starting >go,zero*5 go 999ms refused=none 1ms refused=tripped "
        "guard=ready 100ms >"
    ),
    "a zero takes back the command that waits": "go 5000ms >go,zero*5 go 100ms zero 1000ms stops",
    "two commands are a stream": "stream=2 1000ms is=tripped",
    "a client that sends its time gets no single command": "go=fresh 5000ms is=tripped",
    "a command that waited while the gateway stood still does not go out": (
        "go 5000ms >go,zero*5 go freeze=600 tick refused=tripped >"
    ),
    "a single command that the gateway looks at 250 ms late does not go out": (
        "go 5000ms >go,zero*5 go freeze=500 tick refused=tripped >"
    ),
    "a single command that the gateway looks at a little earlier goes out": (
        "go 5000ms >go,zero*5 go freeze=499 tick refused=none >go"
    ),
    **{
        f"{end} takes back a single command that waits": (  # it is due, and nobody has looked
            f"go 5000ms >go,zero*5 go freeze=260 {end} still"
        )
        for end in ENDS
    },
    # Freshness
    "a stale command is refused and does not hold off the deadline": (
        f"stream=10 {'go=stale 50ms ' * 20}refused=stale_command*20 causes=deadline"
    ),
    "a fresh zero resets at once and a stale one stops but does not reset": TRIPPED
    + "zero=stale 1000ms go=fresh > zero=fresh go=fresh >zero,go zero=stale >zero",
    # The lease
    "a client that drives keeps others out until it is silent for the lease": (
        "stream=10 b:go b:zero refused=not_lease_holder*2 is=moving "
        "zero 1999ms holder=a 1ms holder=none >go*10,zero*5 b:go >go"
    ),
    **{
        f"a stick held before the lease ended moves nothing until it has its {end}": (
            f"stream=10 zero {'b:go 100ms ' * 30}"  # its hand is on the stick, and stays there
            f"holder=none 399ms b:go refused=not_lease_holder*31 >go*10,zero*5 "
            f"{how} b:go refused=none {sent}"
        )
        for end, how, sent in [
            ("zero", "b:zero", ">zero,go"),
            ("silence", "500ms", ">go"),
            ("end", "b:leave", ">go"),
            ("control", "b:acquire", ">go"),
        ]
    },
    "a client that lets go while another drives may push when its lease is over": (
        "stream=10 b:go b:zero release >go*10,zero b:go >go"
    ),
    "a client that only sends zeros does not keep a driver out": (
        "zeros=30 >zero*30 b:go >go zero refused=not_lease_holder is=moving"
    ),
    "a client that has driven keeps others out by zeros for the lease alone": (
        "go zeros=39 b:go refused=not_lease_holder zeros=1 forget c:go >go"
    ),
    "control that was asked for is kept by zeros": (
        "acquire zeros=100 b:go refused=not_lease_holder"
    ),
    "taking control stops the robot first": (
        "stream=10 >go*10 b:acquire causes=takeover >zero "
        "go b:go refused=not_lease_holder,tripped b:zero 250ms forget b:go >go"
    ),
    "a zero of the former driver does not reset for the next one": TRIPPED
    + "zero 100ms b:acquire 200ms b:go refused=tripped",
    "releasing control stops the robot as asked": (
        "stream=10 >go*10 b:release is=moving release >zero b:go >go"
    ),
    # Other stops
    **{
        f"a stop by {event} that the driver did not ask for trips": (
            f"stream=10 >go*10 {event} causes={cause} >zero go refused=tripped 220ms >zero*4"
        )
        for event, cause in STOPS.items()
    },
    **{
        f"{event} of another client does not stop the robot": (
            f"stream=10 >go*10 b:{event} > is=moving"
        )
        for event in ("leave", "revoke", "invalid", "release")
    },
    "a stop of the driver itself does not trip": "stream=10 >go*10 stop >zero go >go",
    "a stop is published although the robot stands": "stop 250ms >zero*5",
    "a shut down drive stays shut": "shutdown zero 300ms stops go refused=tripped >",
    # The guard
    "the guard is needed from the first command until the last zero": (
        "is=unguarded go is=guarded 699ms is=guarded 1ms is=unguarded"
    ),
    **{
        f"a {guard} robot that starts does not move until the stick is let go": (
            f"guard={guard} go guard=starting guard=ready forget stream=10 stops "
            "go says=another_node_began_to_listen zero 300ms stops go >go"
        )
        for guard in ("ready", "prepared")
    },
    "a client that asks for control brings back no command that a stop took back": (
        "stream=2 guard=prepared go "  # waits for the guard
        "freeze=500 acquire causes=deadline >go*2,zero guard=ready > is=tripped"
    ),
    "a command to move that the lost guard refuses ends the reset all the same": TRIPPED
    + "guard=lost zero 100ms go 200ms guard=ready >zero go refused=tripped >",
    # What watchers hear
    "changes are reported once each": "go changes=yes >go 50ms go changes=no",
    "watchers hear that the single command that was left is no more": (
        "go leave is=free forget b:go=fresh changes=yes is=tripped"
    ),
}
WHILE_THE_GUARD_STARTS = {
    "a command waits for a second and moves then for a whole deadline": (
        "go 900ms slow 900ms > " + READY + ">slow 499ms > 1ms >zero"
    ),
    "a command is refused after a second": (
        "go 1000ms says=is_starting:_send_the_command_again " + READY + ">"
    ),
    "a command whose time was over before the guard was ready is refused": (
        "go freeze=1001 " + READY + "refused=tripped >"  # a turn that was late
    ),
    "the last command of a stick waits for the guard for a deadline": (
        "stream=20 refused=none 449ms refused=none "  # longer than one of them may wait
        "1ms refused=tripped " + READY + ">"
    ),
    "a client that asks for control keeps its command that waits": (
        "go acquire refused=none " + READY + ">go"
    ),
    "a command a whole deadline after another is not of a joystick": (
        "go 500ms go 999ms refused=none " + READY + ">go"
    ),
    "a command that waits gets no younger by other events": (
        "go " + "50ms tick " * 20 + "refused=tripped " + READY + ">"
    ),
    "a guard that has discovered the robot is asked for a proof once a command waits": (
        "go is=proved guard=prepared is=unproved > guard=ready is=proved >go "
        "5000ms guard=prepared is=proved"
    ),
    **{
        f"a command that waited is refused for {event} in between": f"go {event} says={why}"
        for event, why in {
            "guard=lost": "ended_or_hung,_and_another",
            "guard=starting": "another_node_began",
            "b:acquire": "another_client_took_control",
            "shutdown": "the_gateway_is_shutting_down",
        }.items()
    },
    "a backlog that waits for the guard is one": "[ zero go*48 ] 50ms guard=ready 1000ms still",
    "a backlog in two segments that waits for the guard is one": (
        "[ go*12 ] 1ms guard=ready 19ms > [ go*24 ] 1000ms still"
    ),
}


@pytest.mark.parametrize("history", HISTORIES.values(), ids=HISTORIES.keys())
def test_rule(history: str):
    Stage().play(history)


@pytest.mark.parametrize(
    "history", WHILE_THE_GUARD_STARTS.values(), ids=WHILE_THE_GUARD_STARTS.keys()
)
def test_while_the_guard_starts(history: str):
    Stage("starting").play(history)


def test_a_command_waits_no_longer_than_its_client_has_control():
    stage = Stage("starting", lease_ns=600 * MS)
    stage.play(
        "go 599ms refused=none holder=a 1ms refused=tripped holder=none guard=ready 1000ms >"
    )


def test_without_the_guard_commands_to_move_are_refused_and_zeros_pass():
    Stage("lost").play("go zero refused=tripped >zero")


@pytest.mark.parametrize(
    "history",
    [
        "go refused=tripped zero 300ms stops go >go b:go refused=not_lease_holder",
        # a push does not trip a client that sent it
        "zeros=10 b:go refused=not_lease_holder >zero*10 go >go",
        # watchers hear that a refused command has set the latch
        "go changes=yes > go changes=no",
    ],
)
def test_if_the_first_command_must_be_zero_nothing_else_takes_control(history: str):
    Stage(first_command="zero").play(history)


def test_a_command_that_is_too_fast_is_clamped_and_its_client_told():
    stage, slower = Stage(max_linear=0.5), Velocity(linear_x=0.5)
    stage.command(Velocity(linear_x=1e308))
    assert [each.velocity for each in stage.out if isinstance(each, Clamped)] == [slower]
    assert stage.look() == [slower]
