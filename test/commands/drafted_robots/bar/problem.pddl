(define (problem evening) (:domain bar)
  (:objects margarita daiquiri - shaken martini lemonade - stirred
    tequila rum gin lemon_juice - bottle rack top_shelf - place
    seat_1 seat_2 seat_3 - seat lime olive mint - garnish)
  (:init (shaker-clean) (upper top_shelf)
    (stands tequila top_shelf) (stands rum rack) (stands gin rack) (stands lemon_juice rack)
    (needs margarita tequila) (needs daiquiri rum) (needs martini gin) (needs lemonade lemon_juice)
    (suits lime margarita) (suits lime daiquiri) (suits olive martini) (suits mint lemonade))
  (:goal (and (served margarita seat_2) (garnished margarita lime) (served lemonade seat_3))))
