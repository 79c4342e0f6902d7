"""What two subscriptions to one topic bring, in whatever order they do."""

from itertools import combinations

from mirror_explainer.node.deliveries import Deliveries


def test_a_message_counts_once_and_one_of_another_topic_for_itself() -> None:
    deliveries = Deliveries()

    told = [deliveries.take(*given) for given in (('plan', 1), ('problem', 1), ('plan', 1))]

    assert told == [True, True, False]


def test_a_middleware_that_tells_no_time_has_every_message_heard() -> None:
    deliveries = Deliveries()

    assert all(deliveries.take('plan', 0) for _ in range(3))


def test_what_was_sent_last_is_heard_last_in_each_order_of_two_subscriptions() -> None:
    # Each brings some of four messages in their order, and the last.
    some = [(*few, 4) for count in range(4) for few in combinations((1, 2, 3), count)]
    for one in some:
        for other in some:
            for places in combinations(range(len(one) + len(other)), len(one)):
                left, right = iter(one), iter(other)
                count = len(one) + len(other)
                brought = [next(left) if at in places else next(right) for at in range(count)]
                deliveries = Deliveries()
                heard = [sent for sent in brought if deliveries.take('plan', sent)]
                assert heard[-1] == 4, brought
