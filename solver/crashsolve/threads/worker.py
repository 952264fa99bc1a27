"""Threads that share a job: they take its pieces, one after the other, until none is left.

    first:   a queue of pieces for each thread,   round += 1,   pieces,   until done == pieces
    others:  until round has changed,   pieces

A thread takes the pieces of its own queue, which lie near each other in memory, and then what is
left in those of others: one that the machine holds up, or that sleeps, costs no more than the piece
it has begun. Which thread does a piece has no effect on what the piece yields, and sums of several
pieces are taken by the first alone, in the order of the pieces (model/partition.py). Consequence to
test: the same bits for any number of threads, and however they are held up.

A queue is one word: the round, the next piece, and the end. So a thread that takes a piece knows
that it is of the present round.
"""

from crashsolve.foundation.atomic import (
    add_release,
    give_way,
    load_acquire,
    replaced,
    sleep,
    store_release,
)
from crashsolve.foundation.kernels import kernel

# indices in `queues`, as far apart as cache lines: round, pieces done, queues of the threads
ROUND, DONE, QUEUES, LINE = 0, 8, 16, 8
# the round in which the threads end
HOME = -1
# parts of the word of a queue
NEXT, OF_ROUND = 2**16, 2**32
MOST_PIECES = NEXT - 1
# looks, some 20 microseconds, before the core is offered to others, and before it is left to them
PATIENCE, OFFERS = 4000, 500
NAP = 100  # microseconds


@kernel
def call(pieces, threads, queues):
    """Call all threads to so many pieces of a job; returns the round. Writes: turns."""
    number = queues[ROUND] + 1
    queues[DONE] = 0
    for k in range(threads):
        begin, end = pieces * k // threads, pieces * (k + 1) // threads
        store_release(queues, QUEUES + LINE * k, number * OF_ROUND + begin * NEXT + end)
    store_release(queues, ROUND, number)
    return number


@kernel
def next_piece(me, number, threads, queues):
    """A piece of this round that no thread has begun; -1: there is none. Writes: turns."""
    for k in range(threads):
        piece = taken(QUEUES + LINE * ((me + k) % threads), number, queues)
        if piece >= 0:
            return piece
    return -1


@kernel
def taken(queue, number, queues):
    """The next piece of a queue; -1: there is none. Writes: turns."""
    while True:
        word = load_acquire(queues, queue)
        piece, end = word // NEXT % NEXT, word % NEXT
        if word // OF_ROUND != number or piece == end:
            return -1
        if replaced(queues, queue, word, word + NEXT):
            return piece


@kernel
def finish(queues):
    """A piece is done. Writes: turns."""
    add_release(queues, DONE, 1)


@kernel
def wait_for_all(pieces, queues):
    """Until all pieces are done."""
    done, looks = load_acquire(queues, DONE), 0
    while done < pieces:
        looks = be_patient(looks)
        done = load_acquire(queues, DONE)


@kernel
def wait_for_call(number, queues):
    """Until there is another round; returns its number."""
    now, looks = load_acquire(queues, ROUND), 0
    while now == number:
        looks = be_patient(looks)
        now = load_acquire(queues, ROUND)
    return now


@kernel
def be_patient(looks):
    """Another look soon, or later the longer this lasts; returns how many there have been."""
    if looks > PATIENCE + OFFERS:
        sleep(NAP)
        return looks
    if looks > PATIENCE:
        give_way()
    return looks + 1
