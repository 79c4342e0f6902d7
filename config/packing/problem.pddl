; A teapot and two cups are to go into the gift box.
(define (problem packing_an_order)
  (:domain packing)
  (:objects
    teapot cups vase candle - thing
    gift_box crate - box)
  (:init
    (gripper-free)
    (on-shelf teapot) (on-shelf cups) (on-shelf vase) (on-shelf candle)
    (empty gift_box) (open gift_box)
    (empty crate) (open crate) (lined crate))
  (:goal (and (packed teapot gift_box) (packed cups gift_box) (labelled gift_box))))
