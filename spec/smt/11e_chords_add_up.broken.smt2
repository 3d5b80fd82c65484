; BROKEN     Twin of 11e_chords_add_up.smt2: the longer of the two chords is taken for both.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const ax Real)       ; from h to h1
(declare-const ay Real)
(declare-const bx Real)       ; from h1 to h2
(declare-const by Real)
(declare-const phi1 Real)     ; first chord, at most
(declare-const phi2 Real)     ; second chord, at most
; Formulas
(define-fun whole () Real (ite (>= phi1 phi2) phi1 phi2))    ; BROKEN: not the sum

; Assumptions
(assert (and (>= phi1 0) (<= (+ (* ax ax) (* ay ay)) (* phi1 phi1))))
(assert (and (>= phi2 0) (<= (+ (* bx bx) (* by by)) (* phi2 phi2))))
(assert (>= (* (- (* ax by) (* ay bx)) (- (* ax by) (* ay bx))) 0))   ; a square: true anyway, a hint for cvc5

; Conclusion, negated
(assert (not (<= (+ (* (+ ax bx) (+ ax bx)) (* (+ ay by) (+ ay by))) (* whole whole))))
(check-sat)
